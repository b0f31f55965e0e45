// One linear or Newton solve of K u = f on a mesh, with the pieces of the tissue and no component.
#pragma once

#include <functional>

#include "block_matrix.h"
#include "corotational_t4.h"
#include "factor.h"
#include "tissue_meshes.h"

namespace sutura::test {

class StaticProblem {
 public:
  StaticProblem(MeshData mesh, const Material& material,
                std::unique_ptr<ElasticModel> model = nullptr)
      : mesh_(std::move(mesh)),
        model_(model ? std::move(model)
                     : std::make_unique<CorotationalT4>(mesh_.points, mesh_.tets)),
        A_(nodes(), model_->pairs()),
        x(stacked(mesh_.points)),
        load(VecX::Zero(x.size())),
        fixed_(mesh_.points.size(), 0) {
    model_->bind(*A_.pattern());
    model_->set_materials(std::vector<Material>(mesh_.tets.size(), material));
  }
  const MeshData& mesh() const { return mesh_; }
  Index nodes() const { return static_cast<Index>(mesh_.points.size()); }
  ElasticModel& model() { return *model_; }

  void fix(const std::function<bool(const Vec3&)>& where) {
    for (std::size_t i = 0; i < fixed_.size(); ++i)
      if (where(mesh_.points[i])) fixed_[i] = 1;
  }
  /// Newton steps with the stiffness of the model; returns the last correction's size.
  Real newton(int steps) {
    const auto plan = make_factor_plan(A_.pattern(), fixed_, {}, default_backend());
    const auto factor = make_factor(plan);
    MatX u;
    for (int i = 0; i < steps; ++i) {
      A_.set_zero();
      VecX force = load;
      model_->linearise(x, 1, A_, force);
      if (!factor->factorise(A_)) return std::numeric_limits<Real>::infinity();
      u = force;
      factor->solve(u);
      x += u.col(0);
    }
    return u.cwiseAbs().maxCoeff();
  }
  VecX elastic_force() {
    VecX force = VecX::Zero(x.size());
    A_.set_zero();
    model_->linearise(x, 1, A_, force);
    return force;
  }

 private:
  MeshData mesh_;
  std::unique_ptr<ElasticModel> model_;
  NodeMatrix A_;

 public:
  VecX x;     ///< positions
  VecX load;  ///< N

 private:
  std::vector<char> fixed_;
};

}  // namespace sutura::test
