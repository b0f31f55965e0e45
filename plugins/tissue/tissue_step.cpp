#include "tissue_step.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "sutura/archive.h"

namespace sutura::tissue {

TissueStep::TissueStep(TissueModel& model, TissueSolver& solver, VecX& load,
                       std::shared_ptr<const NodePattern> pattern)
    : model_(model),
      solver_(solver),
      load_(load),
      x_(model.rest),
      v_(VecX::Zero(model.dofs())),
      start_x_(x_),
      start_v_(v_),
      force_(v_),
      missing_(v_),
      change_(v_),
      assembly_(model, solver),
      A_(std::move(pattern)),
      linearised_at_(x_),
      pushed_(v_),
      reaction_(v_),
      answer_(v_) {
  model_.elastic->bind(*A_.pattern());
}

void TissueStep::prepare(Real dt) {
  model_.held.clear_fixed(v_);
  solver_.analyse(A_.pattern(), model_.held.fixed(), {});
  assemble(dt, 0);
  A_.multiply(v_, change_);  // the product finds its memory; every pass sets the change anew
}

std::string TissueStep::trouble() const {
  std::string text;
  const auto add = [&text](const std::string& clause) {
    if (clause.empty() || text.find(clause) != std::string::npos) return;
    text += (text.empty() ? "" : "; ") + clause;
  };
  add(solver_trouble_);
  add(solver_.report().message);
  if (!finite()) add("the state is no longer finite");
  return text;
}

bool TissueStep::finite() const {
  return x_.allFinite() && v_.allFinite() && std::isfinite(at_work_);
}

void TissueStep::set_state(const VecX& x, const VecX& v) {
  assert(x.size() == model_.dofs() && v.size() == model_.dofs());
  x_ = x;
  v_ = v;
  model_.held.clear_fixed(v_);
}

void TissueStep::archive(Archive& a) {
  a("positions", x_);
  a("velocities", v_);
  a("reaction", reaction_);
  a("linearisations", linearisations_);
  a("assembled_for", assembled_for_);  // another length of step renews the factor
  A_.archive(a);
  a("linearised_at", linearised_at_);
  a("outdated", outdated_);
  a("at_work", at_work_);  // how well the first pass has to be solved
  if (!a.restoring() || !a.ok()) return;
  const Index size = model_.dofs();
  if (x_.size() != size || v_.size() != size || reaction_.size() != size ||
      linearised_at_.size() != size)
    return a.fail("the state of another mesh");
  is_restored_ = true;
}

/// The first guess: every node goes on with the velocity that it has.
void TissueStep::begin(const StepContext& context) {
  if (!in_step_) {
    start_x_ = x_;
    start_v_ = v_;
    in_step_ = true;
  }
  assembly_.begin(start_x_, context.dt);
  v_ = start_v_;
  // A fixed node keeps the velocity that it has: so it is given the one that leads to its target.
  model_.held.set_velocities(start_x_, context.dt, v_);
  x_ = start_x_ + context.dt * v_;
  linearisations_ = 0;
  solver_is_ready_ = false;
  solver_trouble_.clear();
}

/// A and f at the guess.
void TissueStep::assemble(Real h, Index step) {
  assembly_.linearise(x_, h, A_, force_, node_rotations_);
  add_outer_forces();
  linearised_at_ = x_;
  is_restored_ = false;
  outdated_ = false;
  if (linearisations_ > 0 && solver_trouble_.empty()) solver_trouble_ = solver_.report().message;
  ++linearisations_;
  if (h != assembled_for_) solver_.renew();
  assembled_for_ = h;
  solver_.prepare(A_, node_rotations_, step);
  solver_is_ready_ = true;
}

void TissueStep::evaluate_force() {
  assembly_.find_force(x_, *A_.pattern(), force_);
  add_outer_forces();
}

/// Beside the force of the material at x: that of supports and loads.
void TissueStep::add_outer_forces() {
  model_.held.add_force(x_, force_);
  if (load_.size() != model_.dofs()) return;
  for (FollowerLoad* follower : model_.followers) follower->follow(x_, load_);
  force_ += load_;
}

/// missing_ <- r at the guess, with the force that is known there.
void TissueStep::balance(const StepContext& context) {
  const Real h = context.dt, alpha = model_.damping_mass;
  for (Index i = 0; i < static_cast<Index>(model_.mass.size()); ++i) {
    const auto v = v_.segment<3>(3 * i);
    missing_.segment<3>(3 * i) =
        model_.mass[i] * (start_v_.segment<3>(3 * i) - v + h * (context.gravity - alpha * v)) +
        h * force_.segment<3>(3 * i);
  }
}

Real TissueStep::moved_since_linearised() const {
  Real most = 0;
  for (Index i = 0; i < model_.dofs(); i += 3)
    most = std::max(most, (x_.segment<3>(i) - linearised_at_.segment<3>(i)).squaredNorm());
  return std::sqrt(most);
}

/// Momentum below which nothing can be told from rounding.
Real TissueStep::rounding_of(Real dt) const {
  return 1e-7 * dt * at_work_;
}

/// A^-1 of a momentum that is missing, as far as the step asks for it: to a thirtieth of what may
/// be missing at its end. Where little is missing, to a tenth of it, so that what comes to rest
/// does so down to rounding.
void TissueStep::solve_what_matters(const StepContext& context, VecX& momentum) {
  model_.held.clear_fixed(momentum);
  const Real size = momentum.norm(), rounding = rounding_of(context.dt);
  if (size <= rounding) {
    momentum.setZero();
    return;
  }
  const Real may_lack = context.tolerance * context.dt * at_work_;
  const Real enough = std::max(rounding, std::min(may_lack / 30, size / 10));
  solver_.solve(momentum, enough);  // also if it is not finite
  may_stay_ += enough;
}

void TissueStep::linearise(const StepContext& context, const VecX& force) {
  // A turns with the material: as long as nothing has moved by much of an element it may stay, and
  // from step to step as long as it answers well.
  constexpr Real small = 0.02;           // of the mean edge
  const bool first = !solver_is_ready_;  // in this step
  if (context.dt != assembled_for_ || (first && outdated_) ||
      moved_since_linearised() >= small * model_.edge_length) {
    assemble(context.dt, context.step);
    balance(context);
  } else if (first) {
    if (is_restored_) assembly_.restore(linearised_at_, assembled_for_, A_, node_rotations_);
    is_restored_ = false;
    solver_.prepare(A_, node_rotations_, context.step, true);
    solver_is_ready_ = true;
    evaluate_force();
    balance(context);
  }
  pushed_ = context.dt * force;
  change_ = missing_ + pushed_;
  model_.held.clear_fixed(change_);
  asked_ = change_.norm();
  may_stay_ = 0;
  solve_what_matters(context, change_);
}

void TissueStep::push(const StepContext& context, const VecX& force_change) {
  if (force_change.isZero(0)) return;
  answer_ = context.dt * force_change;
  pushed_ += answer_;
  asked_ += answer_.norm();
  solve_what_matters(context, answer_);
  change_ += answer_;
}

void TissueStep::correct(const StepContext& context) {
  const Real h = context.dt;
  v_ += change_;
  x_ = start_x_ + h * v_;
  evaluate_force();
  balance(context);

  // A matrix that leaves more than a hundredth of what it was asked for, beside what the solver may
  // leave, is too old. A new one leaves as much where elements turn within the pass. What the rows
  // leave, as they turn, is not its fault.
  answer_ = missing_ + pushed_;
  const Real left = size_of_free(answer_);
  outdated_ = outdated_ || (left > rounding_of(h) && left > 0.01 * asked_ + may_stay_);
}

/// Of a momentum, without what holds and supports take up (N s).
Real TissueStep::size_of_free(const VecX& momentum) const {
  Real sum = 0;
  for (Index i = 0; i < static_cast<Index>(model_.mass.size()); ++i)
    if (!model_.held.is_fixed(i))
      sum += model_.held.along_free(i, momentum.segment<3>(3 * i)).squaredNorm();
  return std::sqrt(sum);
}

/// What is held goes where it is held, however far that is.
void TissueStep::move_to(const StepContext& context, const VecX& motion) {
  v_ = motion / context.dt;
  model_.held.set_velocities(start_x_, context.dt, v_);
  x_ = start_x_ + context.dt * v_;
  evaluate_force();
  if (solver_is_ready_) balance(context);
}

Imbalance TissueStep::imbalance(const StepContext& context, const VecX& force) {
  const Real h = context.dt;
  Imbalance worst;
  // Sums of squares over the nodes: what is missing, and what is at work.
  Real missing = 0, pushed = force.squaredNorm(), weight = 0, inertia = 0, reaction = 0;
  for (Index i = 0; i < static_cast<Index>(model_.mass.size()); ++i) {
    Vec3 r = missing_.segment<3>(3 * i) / h + force.segment<3>(3 * i);
    if (model_.held.is_fixed(i)) {
      reaction += r.squaredNorm();
      continue;
    }
    // Along a support what is left is its rounding: a gap a million times smaller than any other.
    r = model_.held.along_free(i, r);
    missing += r.squaredNorm();
    if (!(r.norm() <= worst.force)) worst.force = r.norm();
    weight += (model_.mass[i] * context.gravity).squaredNorm();
    inertia += (model_.mass[i] / h * (v_ - start_v_).segment<3>(3 * i)).squaredNorm();
  }
  reaction += model_.held.squared_force(x_);
  const Real rounding = 1e-9 * model_.young * model_.edge_length * model_.edge_length;
  at_work_ = std::sqrt(std::max({pushed, weight, inertia, reaction})) + rounding;
  worst.relative = std::sqrt(missing) / at_work_;
  return worst;
}

Real TissueStep::time_error(const StepContext& context) const {
  Real most = 0;
  for (Index i = 0; i < static_cast<Index>(model_.mass.size()); ++i)
    if (!model_.held.is_fixed(i))
      most = std::max(most, (v_ - start_v_).segment<3>(3 * i).squaredNorm());
  return context.dt / 2 * std::sqrt(most);
}

void TissueStep::rest(const Vec3& gravity) {
  VecX force = load_;
  model_.elastic->add_force(x_, force);
  reaction_.setZero();
  for (Index i = 0; i < model_.dofs() / 3; ++i)
    if (model_.held.is_fixed(i))
      reaction_.segment<3>(3 * i) = -force.segment<3>(3 * i) - model_.mass[i] * gravity;
  model_.held.add_force(x_, reaction_);
}

void TissueStep::end(const StepContext& context, const VecX& force) {
  reaction_.setZero();
  for (Index i = 0; i < model_.dofs() / 3; ++i)
    if (model_.held.is_fixed(i))
      reaction_.segment<3>(3 * i) =
          -missing_.segment<3>(3 * i) / context.dt - force.segment<3>(3 * i);
  model_.held.add_force(x_, reaction_);
  outdated_ = outdated_ || !solver_.report().converged;
  in_step_ = false;
}

}  // namespace sutura::tissue
