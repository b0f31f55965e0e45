// The motion of a tissue in a step: implicit Euler,
//   M (v_new - v) = h (f(x + h v_new) + M g - B v_new + p),   B = alpha M + beta K,
// f elastic, p constraint forces, linearised about a motion with velocity u (at first u = 0: the
// start of the step), so that with A = M + h B + h^2 K at x + h u
//   A (v_new - u) = r + h p,   r = M (v - u) + h (f(x + h u) + M g - B u).
#include <cassert>
#include <cmath>

#include "rotation.h"
#include "tissue.h"

namespace sutura {

/// Linearisations of a step whose motion would otherwise gain energy.
constexpr Index most_linearisations = 5;

std::string Tissue::trouble() const {
  std::string text;
  const auto add = [&text](const std::string& clause) {
    if (clause.empty() || text.find(clause) != std::string::npos) return;
    text += (text.empty() ? "" : "; ") + clause;
  };
  add(solver_trouble_);
  add(solver_->report().message);
  if (linearisations_ > iterations)
    add("a motion too large for the step took " + std::to_string(linearisations_) +
        " linearisations");
  if (!finite()) {
    add("the state is no longer finite");
  } else if (const Index n = inverted(); n > 0) {
    add(std::to_string(n) + (n == 1 ? " tetrahedron is" : " tetrahedra are") + " inverted");
  }
  return text;
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

/// A and r about the motion u = guess_.
void Tissue::linearise(const StepContext& context) {
  const Real h = context.dt, alpha = damping_mass, beta = damping_stiffness;
  A_->set_zero();
  elastic_force_.setZero();
  x_free_ = x_ + h * guess_;
  elastic_->linearise(x_free_, h * h + h * beta, *A_, elastic_force_);
  A_->add_diagonal(mass_, 1 + h * alpha);

  // h beta K u = beta / (h + beta) (A u - (1 + h alpha) M u): K itself is never formed.
  A_->multiply(guess_, product_);
  const Real share = beta / (h + beta);
  for (Index i = 0; i < static_cast<Index>(mass_.size()); ++i) {
    const auto u = guess_.segment<3>(3 * i);
    residual_.segment<3>(3 * i) =
        mass_[i] * (v_.segment<3>(3 * i) - u + h * (context.gravity - alpha * u) +
                    share * (1 + h * alpha) * u) +
        h * elastic_force_.segment<3>(3 * i) - share * product_.segment<3>(3 * i);
  }
  if (solver_->wants_rotations()) update_node_rotations();
  solver_->prepare(*A_, node_rotations_, context.step);
}

/// v_free += A^-1 (h p), p the constraint forces of the last step.
void Tissue::add_constraint_motion(Real h) {
  if (constraint_force_.isZero(0)) return;
  rhs_ = h * constraint_force_;
  solver_->solve(rhs_);
  v_free_ += rhs_;
}

/// Implicit Euler loses energy. If the motion gains more than gravity (and the constraint forces,
/// if it is `pushed`) have put in, the linearisation does not hold: a body flung round by a large
/// angle in one step. Motion of a small part of an element is not even looked at.
bool Tissue::gains_energy(const StepContext& context, bool pushed) {
  const Real h = context.dt;
  Real farthest = 0, before = 0, after = 0, work = 0;
  for (Index i = 0; i < static_cast<Index>(mass_.size()); ++i) {
    const auto v = v_free_.segment<3>(3 * i);
    farthest = std::max(farthest, h * v.norm());
    before += 0.5 * mass_[i] * v_.segment<3>(3 * i).squaredNorm();
    after += 0.5 * mass_[i] * v.squaredNorm();
    work += h * mass_[i] * context.gravity.dot(v);
  }
  if (!(farthest > 0.25 * edge_length_)) return false;
  if (pushed) work += h * constraint_force_.dot(v_free_);
  before += elastic_->energy(x_);
  x_free_ = x_ + h * v_free_;
  after += elastic_->energy(x_free_);
  return after > before + work + 1e-9 * (before + std::abs(work));
}

void Tissue::free_motion(const StepContext& context) {
  const Real h = context.dt;
  guess_.setZero(dofs());
  solver_trouble_.clear();
  linearise(context);
  A_->multiply(v_, product_);  // solved for the change of velocity, which is small
  rhs_ = residual_ - product_;
  solver_->solve(rhs_);
  v_free_ = v_ + rhs_;
  // More linearisations follow the motion under the constraint forces of the last step, which is
  // nearer to the one that will come; their effect is taken off again at the end.
  bool pushed = false;
  for (linearisations_ = 1;
       linearisations_ < iterations ||
       (linearisations_ < most_linearisations && gains_energy(context, pushed));
       ++linearisations_) {
    if (!pushed) add_constraint_motion(h);
    pushed = true;
    guess_ = v_free_;
    if (solver_trouble_.empty()) solver_trouble_ = solver_->report().message;
    linearise(context);
    rhs_ = residual_ + h * constraint_force_;
    solver_->solve(rhs_);
    v_free_ += rhs_;
  }
  if (pushed) add_constraint_motion(-h);
  x_free_ = x_ + h * v_free_;
  queries_[static_cast<std::size_t>(Configuration::free)].move(x_free_);
}

void Tissue::solve(Eigen::Ref<MatX> columns) const {
  solver_->solve(columns);
}

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
  constraint_force_ = force;
  if (any_fixed_) {
    A_->multiply(v_free_ - guess_, product_);
    for (Index i = 0; i < static_cast<Index>(mass_.size()); ++i)
      if (fixed_[i])
        reaction_.segment<3>(3 * i) =
            (product_.segment<3>(3 * i) - residual_.segment<3>(3 * i)) / h -
            force.segment<3>(3 * i);
  }
  v_ = v_free_;
  x_ += h * v_;
  queries_[static_cast<std::size_t>(Configuration::current)].move(x_);
}

/// The material around a node turns as its tets do, each in proportion to its volume, where A was
/// made.
void Tissue::update_node_rotations() {
  const MeshData& data = mesh->data();
  node_rotations_.assign(data.points.size(), Mat3::Zero());
  for (const Tet& t : data.tets) {
    Mat3 D, d;
    for (int c = 0; c < 3; ++c) {
      D.col(c) = data.points[t[c + 1]] - data.points[t[0]];
      d.col(c) = x_free_.segment<3>(3 * t[c + 1]) - x_free_.segment<3>(3 * t[0]);
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
