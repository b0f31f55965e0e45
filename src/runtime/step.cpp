// The time step: what happens, in which order. docs/step.md explains each stage.
// What a stage does that takes more than a few lines is in stages.cpp.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/floating_point.h"
#include "base/stage_timer.h"
#include "runtime/best_guess.h"
#include "runtime/better_guess.h"
#include "runtime/failure.h"
#include "runtime/step_division.h"
#include "solve/idle_blocks.h"
#include "solve/law_residual.h"
#include "sutura/simulation.h"

namespace sutura {
namespace {

/// Times as many passes where no length of the step was solved: what jumps, as a loop that slips
/// off a tool, goes all of its way in any step, however short.
constexpr Index last_try = 5;

/// What a guess lacks, in units of the tolerance that it misses most.
Real times_tolerance(Real relative_violation, const std::vector<Imbalance>& imbalance,
                     const StepLimits& limits) {
  Real most = relative_violation;
  for (const Imbalance& i : imbalance) most = std::max(most, i.relative / limits.tolerance);
  return std::isfinite(most) ? most : std::numeric_limits<Real>::infinity();
}

Real least_free_way(const std::vector<ConstraintSource*>& sources) {
  Real least = 1;
  for (const ConstraintSource* source : sources) least = std::min(least, source->free_way());
  return least;
}

}  // namespace

/// A component that throws ends the run: the bodies stay as they are in the middle of the step.
const StepReport& Simulation::step() {
  if (report_.failure) return report_;
  const FloatingPoint mode;
  const Index number = report_.step + 1;
  Timer timer(report_.seconds);
  begin_report();
  try {
    take_step(timer);
  } catch (...) {
    report_.failure = failure_in_step(asked_, timer.current(), number);
  }
  return report_;
}

/// One step, divided where jaws open or close within it.
void Simulation::take_step(Timer& timer) {
  const Real dt = scene_->dt, end = report_.time + dt;
  for (Real begin = report_.time; begin < end && report_.finite;) {
    timer.enter(Stage::inputs);
    const Real due = due_at(begin, end), next = next_event(due, end);
    const bool whole = begin == report_.time && next == end;
    take_stretch(begin, whole ? dt : next - begin, due, timer);
    begin = next;
  }
  report_.step += 1;
  report_.time = static_cast<Real>(report_.step) * dt;
  if (report_.missed()) ++report_.missed_steps;

  // Files. Read-only.
  timer.enter(Stage::record);
  record();
}

/// A step, or what lies between two events in it; several shorter steps where that is too long to
/// be solved. What is due by `due` has happened when it begins.
void Simulation::take_stretch(Real begin, Real length, Real due, Timer& timer) {
  Index finest = 1;
  for (StepDivision division(scene_->limits.substeps); !division.done();) {
    const Real time = begin + length * division.begin();
    const StepContext context{.dt = length / static_cast<Real>(division.parts()),
                              .time = time,
                              .step = report_.step,
                              .order = scene_->limits.time_order,
                              .gravity = scene_->gravity,
                              .tolerance = scene_->limits.tolerance,
                              .early = std::max(Real(0), due - time)};
    finest = std::max(finest, division.parts());
    const Index most = scene_->limits.passes * (division.is_last_try() ? last_try : 1);
    may_divide_ = division.can_halve();
    const bool balanced = balance(context, most, timer), known = knows_ways();
    const bool solved = balanced && known && is_short_enough(context);
    // However well a guess is balanced, it is of no use where something may have gone through.
    constexpr Real no_use = std::numeric_limits<Real>::infinity();
    const Real lacks = !known ? no_use
                       : balanced
                           ? 0
                           : times_tolerance(relative_violation_, imbalance_, scene_->limits);
    if (!solved && division.try_again(lacks)) continue;
    if (solved && is_revised(context)) continue;
    accept(context, solved, timer);
    if (!report_.finite) break;
    division.next();
  }
  report_.parts += finest;
}

/// Finds the end of the step: where the momentum of every body balances and every law holds, both
/// as measured there. False if `most` passes do not get that far.
bool Simulation::balance(StepContext context, Index most, Timer& timer) {
  // Tracks and graspers say where the tools are at the end of the step, loads what they weigh.
  timer.enter(Stage::inputs);
  for (const NamedBody& b : bodies_) b.body->load().setZero(b.body->dofs());
  for (Driver* driver : drivers_) ask(driver).drive(context);
  for (const NamedBody& b : bodies_) ask(b.body).begin_step(context);
  build(context, timer);
  if (needs_first_order(context)) return balance_in_first_order(context, most, timer);

  forget_passes();
  best_guess_->forget();
  const Index least = least_passes();
  most = std::max(least, most);
  Index saddles = 0;
  while (context.pass < most) {
    better_guess_->begin_pass(settled_);
    pass(context, timer);
    ++context.pass;
    ++report_.passes;
    build(context, timer);
    if (needs_first_order(context)) return balance_in_first_order(context, most, timer);
    timer.enter(Stage::measure);
    const bool balanced = measure(context);
    if (!std::isfinite(violation_)) break;
    if (best_guess_->look(imbalance_, least_free_way(sources_) == 1)) builder_->mark_best_guess();
    if (!balanced || context.pass < least) {
      // What passes leave out is in the rows; without any, each body knows best how to go on.
      timer.enter(Stage::correct);
      if (problem_.rows() == 0)
        better_guess_->forget();
      else if (context.pass < most && better_guess_->move_on(context))
        build(context, timer);
      continue;
    }
    if (may_divide_ && timed_event_is_due(problem_)) return false;
    // Events fire on forces that have been verified, all that are due at once.
    const Index fired = fire_events(problem_);
    most += fired;
    report_.solve.events += fired;
    forget_passes();
    if (fired > 0) continue;
    if (!leave_saddles()) {
      return goes_on_as_before(context) || balance_in_first_order(context, most, timer);
    }
    constexpr Index most_saddles = 16;
    if (++saddles > most_saddles) break;
    most += scene_->limits.passes;
    build(context, timer);
  }
  if (context.order > 1) return balance_in_first_order(context, most, timer);
  end_with_best_guess(context, timer);
  return false;
}

/// Laws compare the end of a step with its start, and an impact has nothing to do with the step
/// before. So a step that turns out to have rows is begun anew, and looks back no further.
bool Simulation::needs_first_order(const StepContext& context) const {
  return context.order > 1 && problem_.rows() > 0;
}

bool Simulation::balance_in_first_order(StepContext context, Index most, Timer& timer) {
  report_.order = context.order = 1;
  context.pass = 0;
  return balance(context, most, timer);
}

/// One linearisation of all that is not settled about the present guess, and the next guess.
void Simulation::pass(const StepContext& context, Timer& timer) {
  // Every body alone: A dv = what its balance lacks.
  timer.enter(Stage::linearise);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (settled_[i]) continue;
    constraint_force(i, problem_.lambda);
    ask(bodies_[i].body).linearise(context, body_force_[i]);
  }
  lead_gaps(context);

  idle_->find(problem_);
  for (bool goes_on = true; goes_on; goes_on = idle_->wake(problem_)) {
    // W = h^2 H A^-1 H^T, the sum over the bodies, of all blocks but the idle ones.
    timer.enter(Stage::compliance);
    ConstraintProblem& problem = idle_->without(problem_);
    problem.W.setZero(problem.rows(), problem.rows());
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      if (problem.bodies[i].size() > 0)
        ask(bodies_[i].body).add_compliance(problem.bodies[i], context.dt, problem.W);

    // lambda, the mode of every block, and by how much lambda has changed.
    timer.enter(Stage::solve);
    solve(problem);

    // What that does to the bodies: dv += h A^-1 H^T (lambda - lambda before).
    timer.enter(Stage::correct);
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (settled_[i]) continue;
      constraint_force(i, lambda_change_);
      ask(bodies_[i].body).push(context, body_force_[i]);
    }
    lead_gaps(context);
  }

  // The next guess.
  timer.enter(Stage::correct);
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    if (!settled_[i]) ask(bodies_[i].body).correct(context);
}

/// The rows at the present guess: H, gap, law, parameters, key; lambda and modes of known keys.
void Simulation::build(const StepContext& context, Timer& timer) {
  using Warm = ConstraintBuilder::Warm;
  build(context, timer, context.pass == 0 ? Warm::step_before : Warm::pass_before);
}

void Simulation::build(const StepContext& context, Timer& timer, ConstraintBuilder::Warm warm) {
  timer.enter(Stage::detect);
  detect(context);
  timer.enter(Stage::build);
  builder_->begin(warm);
  for (ConstraintSource* source : sources_) ask(source).build(context, *builder_);
  builder_->finish();
  report_.blocks = static_cast<Index>(problem_.blocks.size());
  report_.rows = problem_.rows();
  check_rows(problem_, *scene_);
  check_gaps();
}

}  // namespace sutura
