// Conjugate gradients on a device for an AsyncSolver, without the component of a scene.
#pragma once

#include "gradients.h"
#include "sutura/device.h"

namespace sutura::opencl {

class GradientsAlone : public ConjugateGradientDevice {
 public:
  explicit GradientsAlone(Gradients& gradients) : gradients_(gradients) {}
  bool claim() override { return true; }
  bool set_matrix(const NodeMatrixView& A, std::span<const char> fixed) override {
    gradients_.set_matrix(A, fixed);
    return true;
  }
  bool set_elements(const TetElementsView& tets, const NodeMatrixView& pattern,
                    std::span<const char> fixed) override {
    gradients_.set_elements(tets, pattern, fixed);
    return true;
  }
  bool set_viscosity(const VecX& moved, Real share) override {
    gradients_.set_viscosity(moved, share);
    return true;
  }
  bool assemble(const VecX& moved, Real scale, const VecX& diagonal, VecX& force,
                std::vector<Mat3>& rotations) override {
    gradients_.assemble(moved, scale, diagonal, force, rotations);
    return true;
  }
  bool element_force(const VecX& moved, VecX& force) override {
    gradients_.element_force(moved, force);
    return true;
  }
  bool read_matrix(std::span<Real> values) override {
    gradients_.read_matrix(values);
    return true;
  }
  bool set_factor(const SupernodalFactor& factor) override {
    gradients_.set_factor(factor);
    return true;
  }
  bool set_turns(std::span<const Mat3> turns) override {
    gradients_.set_turns(turns);
    return true;
  }
  bool find_turns(std::span<const Mat3> of_factor) override {
    gradients_.find_turns(of_factor);
    return true;
  }
  bool keep(const Eigen::Ref<const MatX>& x, Index next) override {
    gradients_.keep(x, next);
    return true;
  }
  bool solve(const Eigen::Ref<const VecX>& b, Eigen::Ref<VecX> x, Real tolerance,
             Index max_iterations, Report& report) override {
    report = gradients_.solve(b, x, tolerance, max_iterations);
    return true;
  }
  bool entries_of_inverse(std::span<const Index> rows, std::span<const Index> columns,
                          Eigen::Ref<MatX> entries) override {
    gradients_.entries_of_inverse(rows, columns, entries);
    return true;
  }
  bool add_compliance(const KnownCompliance& known, const SparseRows& rows, Real scale,
                      Eigen::Ref<MatX> W) override {
    gradients_.add_compliance(known, rows, scale, W);
    return true;
  }
  const std::string& why_not() const override { return why_not_; }

 private:
  Gradients& gradients_;
  std::string why_not_;
};

}  // namespace sutura::opencl
