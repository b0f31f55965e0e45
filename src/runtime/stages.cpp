// What single stages of the step do, and what the step reports. Their order is in step.cpp.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/stage_timer.h"
#include "runtime/best_guess.h"
#include "runtime/better_guess.h"
#include "solve/idle_blocks.h"
#include "solve/law_check.h"
#include "sutura/simulation.h"

namespace sutura {
namespace {

constexpr Real at_once = 1e-6;  // of a step: 0.1 + 0.2 s is 0.3 s

}  // namespace

void Simulation::begin_report() {
  report_.passes = 0;
  report_.parts = 0;
  report_.order = scene_->limits.time_order;
  report_.solved = report_.finite = true;
  report_.violation = 0;
  report_.solve = {};
  report_.messages.clear();
  report_.faults.clear();
  for (BodyReport& b : report_.bodies) {
    b.imbalance = {};
    b.time_error = 0;
  }
}

/// Events divide a step, but no stretch of it is shorter than a sixteenth: every length of step
/// takes a factor of the tissue. So what is due within a sixteenth after a stretch begins happens
/// as it begins, and what is due just before the end of the step a little earlier. Nothing happens
/// later than it is due: a hand that has turned round by then would throw what it lets go
/// backwards.
Real Simulation::due_at(Real begin, Real end) const {
  const Real shortest = scene_->dt / 16;
  const bool is_last = end - begin < 2 * shortest;
  return is_last ? end - at_once * scene_->dt : begin + shortest;
}

/// Where the step is divided next, after a stretch in which nothing happens after `due`.
Real Simulation::next_event(Real due, Real end) {
  Real next = end;
  for (Driver* driver : drivers_) next = std::min(next, ask(driver).next_event(due));
  if (next > end - at_once * scene_->dt) return end;
  return std::min(next, end - scene_->dt / 16);
}

/// Balanced is not enough where a body can go lower. False if none can.
bool Simulation::leave_saddles() {
  bool left = false;
  for (const NamedBody& b : bodies_) left = ask(b.body).leave_saddle() || left;
  return left;
}

bool Simulation::goes_on_as_before(const StepContext& context) {
  return context.order == 1 || std::all_of(bodies_.begin(), bodies_.end(), [&](const NamedBody& b) {
           return ask(b.body).goes_on_as_before(context);
         });
}

Index Simulation::least_passes() const {
  Index least = 1;
  for (const NamedBody& b : bodies_) least = std::max(least, b.body->least_passes());
  return least;
}

/// A new step, or an event: the passes to come have nothing to do with those before.
void Simulation::forget_passes() {
  std::fill(settled_.begin(), settled_.end(), 0);
  better_guess_->forget();
}

/// body_force_ of one body <- H^T lambda.
void Simulation::constraint_force(std::size_t body, const GrowingVec& lambda) {
  body_force_[body].setZero(bodies_[body].body->dofs());
  problem_.bodies[body].add_transposed(lambda, body_force_[body]);
}

/// If no pass has met the tolerances, the step ends at the guess with the smallest imbalance.
void Simulation::end_with_best_guess(const StepContext& context, Timer& timer) {
  if (!best_guess_->go_back(context)) return;
  if (best_guess_->was_reached()) keep_guess();
  build(context, timer, ConstraintBuilder::Warm::best_guess);
  measure(context);
}

/// What may touch at the present guess. Where a source finds the way to it barred, the guess goes
/// back towards the last one whose way was free. Towards the start of the step, what is held would
/// be torn from where it is held, and what the passes have found so far would be lost.
void Simulation::detect(const StepContext& context) {
  if (context.pass == 0)
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      ask(bodies_[i].body).motion(free_motion_[i]);
      free_motion_[i].setZero();
    }
  constexpr int most_looks = 8;
  for (int look = 0;; ++look) {
    for (ConstraintSource* source : sources_) ask(source).detect(context);
    Real part = 1;
    for (ConstraintSource* source : sources_) part = std::min(part, ask(source).free_way());
    if (part >= 1) break;
    if (look > most_looks) return;
    if (look == most_looks) part = 0;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      ask(bodies_[i].body).motion(motion_[i]);
      motion_[i] = free_motion_[i] + part * (motion_[i] - free_motion_[i]);
      bodies_[i].body->move_to(context, motion_[i]);
    }
  }
  for (std::size_t i = 0; i < bodies_.size(); ++i) ask(bodies_[i].body).motion(free_motion_[i]);
  keep_guess();
}

void Simulation::keep_guess() {
  for (ConstraintSource* source : sources_) ask(source).keep_guess();
}

/// A gap that is no number would go unnoticed: every comparison with it is false. Where a body is
/// not finite either, the step ends for that reason.
void Simulation::check_gaps() {
  if (problem_.gap.allFinite()) return;
  for (const NamedBody& b : bodies_)
    if (!b.body->finite()) return;
  for (const ConstraintBlock& b : problem_.blocks) {
    if (problem_.gap.segment(b.first_row, b.law->dim).allFinite()) continue;
    const std::vector<Component*> components = scene_->components();
    const Index source = source_of(b.key);  // numbered from 1, unless its key is made up
    if (source >= 1 && source <= static_cast<Index>(components.size()))
      asked_ = components[static_cast<std::size_t>(source) - 1];
    throw std::domain_error("the gap of a row is not a finite number");
  }
}

/// d_free <- where the answer of the bodies so far leads the gaps.
void Simulation::lead_gaps(const StepContext& context) {
  problem_.d_free = problem_.gap;
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    if (!settled_[i])
      problem_.bodies[i].add_product(context.dt, bodies_[i].body->change(), problem_.d_free);
}

/// `problem`: what is not idle. Events wait: lambda is that of a guess. The report counts them over
/// the whole step.
void Simulation::solve(ConstraintProblem& problem) {
  law_check_->begin(problem);
  problem.hold_events = true;
  const Index events = report_.solve.events;
  lambda_change_ = -problem_.lambda;
  report_.solve = problem.rows() > 0 ? ask(solver_).solve(problem) : SolveReport{};
  report_.solve.events = events;
  idle_->put_back(problem_);
  lambda_change_ += problem_.lambda;
}

/// Momentum and violation of the present guess, with rows and forces as they are there. Where the
/// gaps are good, a body well within the tolerance stays as it is in the next pass, which is for
/// the others: often the thread alone, at a hundredth of the cost of the tissue. What changes of
/// the forces on it counts in its balance.
bool Simulation::measure(const StepContext& context) {
  const StepLimits& limits = scene_->limits;
  const LawCheck::Miss miss = law_check_->measure(problem_, limits.gap_tolerance);
  violation_ = miss.violation;
  relative_violation_ = miss.relative;
  bool good = miss.relative <= 1;
  const bool close = miss.relative <= 0.5;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    constraint_force(i, problem_.lambda);
    imbalance_[i] = ask(bodies_[i].body).imbalance(context, body_force_[i]);
    good = good && imbalance_[i].relative <= limits.tolerance;
    settled_[i] = close && imbalance_[i].relative <= limits.tolerance / 20;
    violation_ += 0 * imbalance_[i].relative;  // not finite if any is
  }
  return good;
}

/// Whether the balanced guess is as near to the motion in continuous time as the scene asks. A part
/// of a step may cost its share of what a step may.
bool Simulation::is_short_enough(const StepContext& context) {
  for (const NamedBody& b : bodies_)
    if (!ask(b.body).tells_when()) return false;
  const Real most = scene_->limits.time_tolerance * context.dt / scene_->dt;
  return most == 0 || std::all_of(bodies_.begin(), bodies_.end(), [&](const NamedBody& b) {
           return ask(b.body).time_error(context) <= most;
         });
}

/// Whether every source knows where things have gone on their way to the guess.
bool Simulation::knows_ways() {
  return std::all_of(sources_.begin(), sources_.end(),
                     [&](ConstraintSource* source) { return ask(source).knows_way(); });
}

/// Whether a source has given up what it took for given in this guess. All of them are asked.
bool Simulation::is_revised(const StepContext& context) {
  bool revised = false;
  const SolvedBlocks blocks(problem_);
  for (ConstraintSource* source : sources_) revised |= ask(source).revise(context, blocks);
  return revised;
}

/// The guess becomes the end of the step. The only place where topology and the number of rows may
/// change.
void Simulation::accept(const StepContext& context, bool solved, Timer& timer) {
  timer.enter(Stage::commit);
  builder_->accept();
  report_.solved = report_.solved && solved;
  report_.violation = std::max(report_.violation, violation_);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    Body& body = ask(bodies_[i].body);
    report_.bodies[i].time_error += body.time_error(context);
    Imbalance& worst = report_.bodies[i].imbalance;
    if (!(imbalance_[i].relative <= worst.relative)) worst = imbalance_[i];
    Work& work = report_.bodies[i].work;
    work.constraints += context.dt * body.power(body_force_[i]);
    work.loads += context.dt * body.power(body.load());
    body.end_step(context, body_force_[i]);
    work.holds += context.dt * body.held_power();
    report_.finite = report_.finite && body.finite();
    const std::string trouble = body.trouble();
    if (!trouble.empty()) report_.messages.push_back(bodies_[i].path + ": " + trouble);
    note_fault(bodies_[i].path, body.fault());
  }
  if (auto* component = dynamic_cast<Component*>(solver_)) {
    const std::string trouble = solver_->trouble();
    if (!trouble.empty()) report_.messages.push_back(component->path() + ": " + trouble);
  }
  if (!report_.finite) return;  // a state that is not finite is not searched
  const SolvedBlocks blocks(problem_);
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    ask(sources_[i]).commit(context, blocks);
    note_fault(source_paths_[i], sources_[i]->fault());
  }
}

/// Once for a component and step, also where the step is divided.
void Simulation::note_fault(const std::string& path, const std::string& fault) {
  const auto is_known = [&](const std::string& other) { return other.starts_with(path + ": "); };
  if (!fault.empty() && std::none_of(report_.faults.begin(), report_.faults.end(), is_known))
    report_.faults.push_back(path + ": " + fault);
}

Imbalance StepReport::worst_imbalance() const {
  Imbalance worst;
  for (const BodyReport& b : bodies)
    if (!(b.imbalance.relative <= worst.relative)) worst = b.imbalance;
  return worst;
}

Real StepReport::worst_time_error() const {
  Real worst = 0;
  for (const BodyReport& b : bodies) worst = std::max(worst, b.time_error);
  return worst;
}

double StepReport::total_seconds() const {
  double sum = 0;
  for (const double s : seconds) sum += s;
  return sum;
}

}  // namespace sutura
