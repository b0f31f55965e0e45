// The motion of a tissue in a step. With A = M + h B + h^2 K, B = alpha M + beta K,
//   A dv = h (f - B v - h K v) + ...  is the same as  A (v + dv) = M v + h f,
// f the elastic force and weight at the start of the step.
#include <cassert>

#include "rotation.h"
#include "tissue.h"

namespace sutura {

/// What has to wait until every Layer and Attach has spoken.
void Tissue::start() {
  solver_->analyse(A_->pattern(), fixed_, {});
  started_ = true;
}

void Tissue::set_state(const VecX& x, const VecX& v) {
  assert(x.size() == dofs() && v.size() == dofs());
  x_ = x_free_ = x;
  v_ = v_free_ = v;
  for (std::size_t i = 0; i < fixed_.size(); ++i)
    if (fixed_[i]) v_.segment<3>(3 * static_cast<Index>(i)).setZero();
  for (const Configuration c : {Configuration::current, Configuration::free})
    queries_[static_cast<std::size_t>(c)].move(c == Configuration::current ? x_ : x_free_);
}

void Tissue::free_motion(const StepContext& context) {
  if (!started_) start();
  const Real h = context.dt;
  A_->set_zero();
  elastic_force_.setZero();
  elastic_->linearise(x_, h * h + h * damping_stiffness, *A_, elastic_force_);
  A_->add_diagonal(mass_, 1 + h * damping_mass);

  A_->multiply(v_, product_);
  rhs_.resize(dofs());
  for (Index i = 0; i < static_cast<Index>(mass_.size()); ++i)
    rhs_.segment<3>(3 * i) = h * (elastic_force_.segment<3>(3 * i) + mass_[i] * context.gravity) +
                             mass_[i] * v_.segment<3>(3 * i) - product_.segment<3>(3 * i);
  if (solver_->wants_rotations()) update_node_rotations();
  solver_->prepare(*A_, node_rotations_, context.step);
  solver_->solve(rhs_);
  v_free_ = v_ + rhs_;
  x_free_ = x_ + h * v_free_;
  queries_[static_cast<std::size_t>(Configuration::free)].move(x_free_);
}

void Tissue::solve(Eigen::Ref<MatX> columns) const { solver_->solve(columns); }

void Tissue::add_compliance(const BodyRows& rows, Real dt, Eigen::Ref<MatX> W) const {
  add_tissue_compliance(*solver_, rows, dt, W);
}

void Tissue::correct(const StepContext& context, const VecX& force) {
  const Real h = context.dt;
  if (!force.isZero(0)) {
    rhs_ = h * force;
    solver_->solve(rhs_);
    v_free_ += rhs_;
  }
  if (any_fixed_) {
    A_->multiply(v_free_, product_);
    for (Index i = 0; i < static_cast<Index>(mass_.size()); ++i)
      if (fixed_[i])
        reaction_.segment<3>(3 * i) =
            (product_.segment<3>(3 * i) - mass_[i] * v_.segment<3>(3 * i)) / h -
            elastic_force_.segment<3>(3 * i) - mass_[i] * context.gravity - force.segment<3>(3 * i);
  }
  v_ = v_free_;
  x_ += h * v_;
  queries_[static_cast<std::size_t>(Configuration::current)].move(x_);
}

/// The material around a node turns as its tets do, each in proportion to its volume.
void Tissue::update_node_rotations() {
  const MeshData& data = mesh->data();
  node_rotations_.assign(data.points.size(), Mat3::Zero());
  for (const Tet& t : data.tets) {
    Mat3 D, d;
    for (int c = 0; c < 3; ++c) {
      D.col(c) = data.points[t[c + 1]] - data.points[t[0]];
      d.col(c) = x_.segment<3>(3 * t[c + 1]) - x_.segment<3>(3 * t[0]);
    }
    // F times six volumes, without a division: cof D = det D D^-T.
    Mat3 cofactors;
    cofactors << D.col(1).cross(D.col(2)), D.col(2).cross(D.col(0)), D.col(0).cross(D.col(1));
    const Mat3 weighted = d * cofactors.transpose();
    for (const Index i : t) node_rotations_[i] += weighted;
  }
  for (Mat3& R : node_rotations_) R = nearest_rotation(R / R.norm());
}

}  // namespace sutura
