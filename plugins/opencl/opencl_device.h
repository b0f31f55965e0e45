// An OpenCL device as a component of a scene. Solvers that name it compute there.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "gradients.h"
#include "sutura/component.h"
#include "sutura/describe.h"
#include "sutura/device.h"
#include "sweeps.h"

namespace sutura::opencl {

enum class OnFailure { stop, cpu };

class OpenClDevice : public Component, public SweepDevice, public ConjugateGradientDevice {
 public:
  static constexpr const char* interface_name = "OpenClDevice";
  std::string device;
  DeviceType type = DeviceType::any;
  Index index = 0;
  Precision precision = Precision::automatic;
  OnFailure on_failure = OnFailure::stop;

  static void describe(Describe<OpenClDevice>& d);
  void initialise(Setup& setup) override;

  bool load(const ConstraintProblem& problem) override;
  bool sweep(ConstraintProblem& problem, std::span<const std::uint32_t> orders) override;
  bool solve_tangents(const TangentSystem& system, TangentAnswer& answer) override;
  bool is_rough() const override { return in_use_ != Precision::double_; }

  bool claim() override { return !std::exchange(claimed_, true); }
  bool set_matrix(const NodeMatrixView& A, std::span<const char> fixed) override;
  bool set_elements(const TetElementsView& tets, const NodeMatrixView& pattern,
                    std::span<const char> fixed) override;
  bool set_viscosity(const VecX& moved, Real share) override;
  bool assemble(const VecX& moved, Real scale, const VecX& diagonal, VecX& force,
                std::vector<Mat3>& rotations) override;
  bool element_force(const VecX& moved, VecX& force) override;
  bool read_matrix(std::span<Real> values) override;
  bool set_factor(const SupernodalFactor& factor) override;
  bool set_turns(std::span<const Mat3> turns) override;
  bool find_turns(std::span<const Mat3> of_factor) override;
  bool keep(const Eigen::Ref<const MatX>& x, Index next) override;
  bool solve(const Eigen::Ref<const VecX>& b, Eigen::Ref<VecX> x, Real tolerance,
             Index max_iterations, ConjugateGradientDevice::Report& report) override;
  bool entries_of_inverse(std::span<const Index> rows, std::span<const Index> columns,
                          Eigen::Ref<MatX> entries) override;

  bool add_compliance(const KnownCompliance& known, const SparseRows& rows, Real scale,
                      Eigen::Ref<MatX> W) override;

  const std::string& why_not() const override { return why_not_; }
  /// The device, null where there is none. For tests, which lose it.
  Device* opened() { return device_.get(); }

 private:
  /// Does it unless the device is lost, and says whether it was done. A device that has failed once
  /// is not asked again.
  template <class Work>
  bool attempt(const Work& work);

  std::unique_ptr<Device> device_;
  Precision in_use_ = Precision::double_;
  std::unique_ptr<Sweeps> sweeps_;
  std::unique_ptr<Gradients> gradients_;
  bool lost_ = false, claimed_ = false;
  std::string why_not_;
};

}  // namespace sutura::opencl
