// The motion of a tissue in a step: implicit Euler,
//   M (v - v_start) = h (f(x_start + h v) + M g - B v + p),   B = alpha M + beta K,
// f elastic, p constraint forces. At a guess v, with A = M + h B + h^2 K,
//   A dv = r + h p,   r = M (v_start - v) + h (f(x) + M g - B v).
#include <cassert>
#include <cmath>

#include "node_rotations.h"
#include "tissue.h"

namespace sutura {

std::string Tissue::trouble() const {
  std::string text;
  const auto add = [&text](const std::string& clause) {
    if (clause.empty() || text.find(clause) != std::string::npos) return;
    text += (text.empty() ? "" : "; ") + clause;
  };
  add(solver_trouble_);
  add(solver_->report().message);
  if (!finite()) add("the state is no longer finite");
  return text;
}

std::string Tissue::fault() const {
  const Index n = inverted();
  return n == 0 ? ""
                : std::to_string(n) + (n == 1 ? " tetrahedron is" : " tetrahedra are") +
                      " turned inside out";
}

void Tissue::move_queries(Configuration c, const VecX& x) {
  queries_[static_cast<std::size_t>(c)].move(x);
}

void Tissue::set_state(const VecX& x, const VecX& v) {
  assert(x.size() == dofs() && v.size() == dofs());
  x_ = x;
  v_ = v;
  for (std::size_t i = 0; i < fixed_.size(); ++i)
    if (fixed_[i]) v_.segment<3>(3 * static_cast<Index>(i)).setZero();
  move_queries(Configuration::current, x_);
}

/// The first guess: on as before.
void Tissue::begin_step(const StepContext& context) {
  if (!in_step_) {
    start_x_ = x_;
    start_v_ = v_;
    move_queries(Configuration::start, start_x_);
    in_step_ = true;
  }
  v_ = start_v_;
  // A fixed node keeps the velocity that it has: so it is given the one that leads to its target.
  for (const Carried& c : carried_)
    v_.segment<3>(3 * c.node) = (c.target - start_x_.segment<3>(3 * c.node)) / context.dt;
  x_ = start_x_ + context.dt * v_;
  move_queries(Configuration::current, x_);
  linearisations_ = 0;
  solver_trouble_.clear();
}

/// A and f at the guess.
void Tissue::assemble(const StepContext& context) {
  const Real h = context.dt;
  A_->set_zero();
  elastic_force_.setZero();
  elastic_->linearise(x_, h * h + h * damping_stiffness, *A_, elastic_force_);
  stiffen_supports(h * h + h * damping_stiffness);
  add_outer_forces();
  A_->add_diagonal(mass_, 1 + h * damping_mass);
  linearised_at_ = x_;
  if (linearisations_ > 0 && solver_trouble_.empty()) solver_trouble_ = solver_->report().message;
  ++linearisations_;
  if (solver_->wants_rotations()) node_rotations(mesh->data(), x_, node_rotations_);
  if (h != assembled_for_) solver_->renew();
  assembled_for_ = h;
  solver_->prepare(*A_, node_rotations_, context.step);
}

/// missing_ <- r at the guess, with the elastic force that is known there.
void Tissue::balance(const StepContext& context) {
  const Real h = context.dt, alpha = damping_mass, beta = damping_stiffness;
  // h beta K v = beta / (h + beta) (A v - (1 + h alpha) M v): K itself is never formed.
  const Real share = beta / (h + beta);
  product_.setZero(dofs());
  if (beta > 0) A_->multiply(v_, product_);
  for (Index i = 0; i < static_cast<Index>(mass_.size()); ++i) {
    const auto v = v_.segment<3>(3 * i);
    missing_.segment<3>(3 * i) =
        mass_[i] * (start_v_.segment<3>(3 * i) - v + h * (context.gravity - alpha * v) +
                    share * (1 + h * alpha) * v) +
        h * elastic_force_.segment<3>(3 * i) - share * product_.segment<3>(3 * i);
  }
}

Real Tissue::moved_since_linearised() const {
  Real most = 0;
  for (Index i = 0; i < dofs(); i += 3)
    most = std::max(most, (x_.segment<3>(i) - linearised_at_.segment<3>(i)).squaredNorm());
  return std::sqrt(most);
}

/// A^-1 of a momentum that is missing, to a thousandth: a pass leaves more than that by being
/// linear. Less than 1e-7 of the forces at work is rounding.
void Tissue::solve_what_matters(const StepContext& context, VecX& momentum) {
  for (std::size_t i = 0; i < fixed_.size(); ++i)
    if (fixed_[i]) momentum.segment<3>(3 * static_cast<Index>(i)).setZero();
  const Real size = momentum.norm(), rounding = 1e-7 * context.dt * at_work_;
  if (size <= rounding)
    momentum.setZero();
  else
    solver_->solve(momentum, std::max(rounding, 1e-3 * size));  // also if it is not finite
}

void Tissue::linearise(const StepContext& context, const VecX& force) {
  // A turns with the material: as long as nothing has moved by much of an element it may stay.
  constexpr Real small = 0.02;  // of the mean edge
  if (linearisations_ == 0 || !(moved_since_linearised() < small * edge_length_)) {
    assemble(context);
    balance(context);
  }
  change_ = missing_ + context.dt * force;
  solve_what_matters(context, change_);
}

void Tissue::solve(Eigen::Ref<MatX> columns) const {
  solver_->solve(columns);
}

void Tissue::add_compliance(const BodyRows& rows, Real dt, Eigen::Ref<MatX> W) const {
  add_tissue_compliance(*solver_, rows, dt, W);
}

void Tissue::correct(const StepContext& context, const VecX& force_change) {
  const Real h = context.dt;
  v_ += change_;
  if (!force_change.isZero(0)) {
    rhs_ = h * force_change;
    solve_what_matters(context, rhs_);
    v_ += rhs_;
  }
  x_ = start_x_ + h * v_;
  move_queries(Configuration::current, x_);
  elastic_force_.setZero();
  elastic_->add_force(x_, elastic_force_);
  add_outer_forces();
  balance(context);
}

Imbalance Tissue::imbalance(const StepContext& context, const VecX& force) {
  const Real h = context.dt;
  Imbalance worst;
  // Sums of squares over the nodes: what is missing, and what is at work.
  Real missing = 0, pushed = force.squaredNorm(), weight = 0, inertia = 0, reaction = 0;
  for (Index i = 0; i < static_cast<Index>(mass_.size()); ++i) {
    Vec3 r = missing_.segment<3>(3 * i) / h + force.segment<3>(3 * i);
    if (fixed_[static_cast<std::size_t>(i)]) {
      reaction += r.squaredNorm();
      continue;
    }
    // Along a support what is left is its rounding: a gap a million times smaller than any other.
    if (!supports_.empty()) r = r.cwiseProduct(slides_.segment<3>(3 * i));
    missing += r.squaredNorm();
    if (!(r.norm() <= worst.force)) worst.force = r.norm();
    weight += (mass_[i] * context.gravity).squaredNorm();
    inertia += (mass_[i] / h * (v_ - start_v_).segment<3>(3 * i)).squaredNorm();
  }
  for (const Support& s : supports_) reaction += support_force(s).squaredNorm();
  const Real rounding = 1e-9 * young * edge_length_ * edge_length_;
  at_work_ = std::sqrt(std::max({pushed, weight, inertia, reaction})) + rounding;
  worst.relative = std::sqrt(missing) / at_work_;
  return worst;
}

void Tissue::end_step(const StepContext& context, const VecX& force) {
  reaction_.setZero();
  for (std::size_t i = 0; i < fixed_.size(); ++i) {
    const auto n = 3 * static_cast<Index>(i);
    if (fixed_[i])
      reaction_.segment<3>(n) = -missing_.segment<3>(n) / context.dt - force.segment<3>(n);
  }
  for (const Support& s : supports_) reaction_.segment<3>(3 * s.node) += support_force(s);
  in_step_ = false;
}

}  // namespace sutura
