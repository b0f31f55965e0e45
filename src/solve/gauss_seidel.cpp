#include "solve/gauss_seidel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace sutura {

namespace {

// Rows that repeat each other (redundant_rows.h): sweeps after which they are softened, also where
// linear rows are eliminated, how often what gave way is taken back, and what need not be (m).
constexpr Index patience = 5, patience_with_others = 3, never = std::numeric_limits<Index>::max();
constexpr int most_taken_back = 3;
constexpr Real negligible = 1e-12;
// A pass, whose events are held, is not the last word: it need not be solved to less than so many
// tolerances of what it begins with, nor of the units.
constexpr Real coarser = 1e3;
// Pauses between direct steps that do not get ahead, in sweeps: after which of them the slower walk
// is tried too, and the longest. What is not solved then was never found by going on.
constexpr Index walk_after = 4, longest_pause = 64;
// Sweeps for what is left beside linear rows. And how often what rounding leaves is solved again.
constexpr Index most_for_others = 30;
constexpr int most_refined = 3;

}  // namespace

/// A new order for every sweep: good whatever the graph of contacts.
/// Seeded per solve, so that the result depends on the problem and the seed alone.
void BlockGaussSeidel::shuffle() {
  for (std::size_t i = order_.size(); i > 1; --i) {
    random_ += 0x9e3779b97f4a7c15ULL;  // SplitMix64 (Steele, Lea, Flood 2014)
    std::uint64_t z = random_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    std::swap(order_[i - 1], order_[(z ^ (z >> 31)) % i]);
  }
}

void BlockGaussSeidel::sweep(ConstraintProblem& problem) {
  shuffle();
  for (const std::size_t i : order_) {
    ConstraintBlock& b = problem.blocks[i];
    const int dim = b.law->dim;
    Real* lambda = problem.lambda.data() + b.first_row;
    Real d[max_block_dim], change[max_block_dim];
    own_free_violation(dim, compliance_[i], problem.delta.data() + b.first_row, lambda, d);
    std::copy_n(lambda, dim, change);
    b.law->project({compliance_[i], d, problem.block_params(b), &b.mode, lambda});
    for (int k = 0; k < dim; ++k) change[k] = lambda[k] - change[k];
    compliance_.add_change(problem, i, change);
  }
}

/// The same sweeps in the same order on the device. Returns how many; 0 if the device does not
/// answer, and the CPU goes on from where the problem stands.
Index BlockGaussSeidel::sweep_on_device(ConstraintProblem& problem, Real residual, Index most) {
  // A direct step is weighed after every sweep, and events may be due once the residual is small.
  // Otherwise it need not be looked at so often.
  constexpr Index at_once = 8;
  const bool looks = options_.acceleration != Acceleration::none || residual <= event_gate;
  const Index count = looks ? Index{1} : std::min(at_once, most);
  orders_.clear();
  for (Index s = 0; s < count; ++s) {
    shuffle();
    for (const std::size_t i : order_) orders_.push_back(static_cast<std::uint32_t>(i));
  }
  on_device_ = device_->sweep(problem, orders_);
  if (!on_device_) {
    trouble_ = device_->why_not();
    return 0;
  }
  if (device_->is_rough()) compliance_.update_delta(problem);
  return count;
}

void BlockGaussSeidel::conjugate(ConstraintProblem& problem) {
  // The change of a sweep is minus the gradient; Fletcher-Reeves, restarted when it grows.
  const Real gradient = (problem.lambda - before_).squaredNorm();
  if (last_gradient_ > 0 && gradient <= last_gradient_) {
    problem.lambda += (gradient / last_gradient_) * search_;
    compliance_.update_delta(problem);
  }
  search_ = problem.lambda - before_;
  last_gradient_ = gradient;
}

/// Counted in multiplications: the sweeps still needed at the present rate against one
/// factorisation.
bool BlockGaussSeidel::direct_step_pays(const ConstraintProblem& problem, Index free, Real before,
                                        Real now) const {
  const Real n = static_cast<Real>(problem.rows()), f = static_cast<Real>(free);
  const Real rate = std::clamp(now / before, Real(1e-3), Real(0.9999));
  const Real sweeps_left = std::log(goal_ / now) / std::log(rate);
  return sweeps_left * n * n > f * f * f / 6 + f * n + 2 * n * n;
}

SolveReport BlockGaussSeidel::solve(ConstraintProblem& problem) {
  trouble_.clear();
  if (problem.blocks.empty()) return {};
  goal_ = 0;  // not known yet
  SolveReport first;
  const bool is_done = options_.acceleration == Acceleration::subspace && linear_.find(problem) &&
                       !is_solved(problem) && linear_.eliminate(problem, others_) &&
                       solve_others(problem, first);
  compliance_.prepare(problem);
  SolveReport report = iterate(problem, is_done ? 0 : options_.sweeps, patience);
  report.sweeps += first.sweeps;
  report.direct_solves += first.direct_solves;
  report.factorisations += first.factorisations;
  return report;
}

bool BlockGaussSeidel::solve_others(ConstraintProblem& problem, SolveReport& report) {
  // Events are due when all is solved, and rows that contradict each other would be in their way.
  const Index firm = problem.hold_events ? patience_with_others : never;
  others_.hold_events = true;
  for (int refined = 0;; ++refined) {
    compliance_.keep(linear_.others());
    const SolveReport now = iterate(others_, std::min(most_for_others, options_.sweeps), firm);
    report.sweeps += now.sweeps;
    report.direct_solves += now.direct_solves;
    report.factorisations += now.factorisations;
    if (!now.converged && !contradict_) break;
    linear_.put_back(others_, problem);
    load(problem);
    if (contradict_) return true;
    if (look(problem).value <= goal_) return false;
    if (refined == most_refined) break;
    linear_.refine(problem, others_);
  }
  linear_.give_up(problem);
  return false;
}

Real BlockGaussSeidel::goal_of(const ConstraintProblem& problem, Real before) const {
  if (!problem.hold_events || !(before > 0)) return options_.tolerance;
  return options_.tolerance * std::max(Real(1), coarser * std::min(before, Real(1)));
}

bool BlockGaussSeidel::is_solved(ConstraintProblem& problem) {
  load(problem);
  const Real residual = look(problem).value;
  goal_ = goal_of(problem, residual);
  return residual <= goal_;
}

Residual BlockGaussSeidel::look(ConstraintProblem& problem) {
  return natural_map(problem, compliance_, lambda_plus_);
}

/// The problem is another one since the last sweep: what was learned from sweeps counts no more.
Residual BlockGaussSeidel::look_anew(ConstraintProblem& problem) {
  pause_ = {};
  last_gradient_ = 0;
  return look(problem);
}

/// For the compliance that the blocks have now.
void BlockGaussSeidel::load(ConstraintProblem& problem) {
  compliance_.prepare(problem);
  compliance_.update_delta(problem);
}

void BlockGaussSeidel::begin(ConstraintProblem& problem) {
  if (!problem.lambda.allFinite()) problem.lambda.setZero();
  compliance_.update_delta(problem);
  random_ = options_.seed;
  order_.resize(problem.blocks.size());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  if (options_.acceleration == Acceleration::nncg) search_.setZero(problem.rows());
  on_device_ = device_ != nullptr && device_->load(problem);
  if (device_ != nullptr && !on_device_) trouble_ = device_->why_not();
  subspace_.begin(on_device_ ? device_ : nullptr);
}

/// One sweep; on a device perhaps more of them, up to `most`.
Index BlockGaussSeidel::sweep_once(ConstraintProblem& problem, bool first, Real residual,
                                   Index most) {
  if (options_.acceleration == Acceleration::nncg) before_ = problem.lambda;
  Index swept = 0;
  // With the direct step one sweep is often all, and W may be in the cache here.
  const bool here = first && options_.acceleration == Acceleration::subspace;
  if (on_device_ && !here) swept = sweep_on_device(problem, residual, most);
  if (swept == 0) {
    sweep(problem);
    swept = 1;
  }
  if (options_.acceleration == Acceleration::nncg) conjugate(problem);
  return swept;
}

/// After a sweep that took the residual from `before` to `residual`, if it pays.
void BlockGaussSeidel::step_directly(ConstraintProblem& problem, Real before, Residual& residual,
                                     SolveReport& report) {
  if (options_.acceleration != Acceleration::subspace || residual.value <= goal_) return;
  if (--pause_.left >= 0) return;
  const Index free = subspace_.gather(problem, compliance_);
  if (!direct_step_pays(problem, free, before, residual.value)) return;
  const Real by_sweeps = residual.value;
  const bool may_walk = pause_.length == walk_after;
  residual =
      subspace_.newton(problem, compliance_, residual, goal_, lambda_plus_, report, may_walk);
  // Modes were not right yet: let sweeps find them, longer each time.
  const bool ahead = residual.value < 0.1 * std::min(by_sweeps, pause_.best);
  pause_.best = std::min(pause_.best, residual.value);
  pause_.length = ahead ? 1 : 2 * pause_.length;
  pause_.left = pause_.length;
}

SolveReport BlockGaussSeidel::iterate(ConstraintProblem& problem, Index sweeps, Index firm) {
  SolveReport report;
  begin(problem);
  Residual residual = look_anew(problem);
  if (goal_ == 0) goal_ = goal_of(problem, residual.value);
  bool softened = false;
  int taken_back = 0;
  while (std::isfinite(residual.value)) {
    const bool converged = residual.value <= goal_;
    if (converged && softened && taken_back < most_taken_back) {
      ++taken_back;
      if (redundant_.take_back(problem) > negligible) {
        compliance_.update_delta(problem);
        residual = look(problem);
        continue;
      }
    }
    if (!converged && !softened && report.sweeps >= firm &&
        redundant_.soften(problem, compliance_)) {
      softened = true;
      load(problem);
      if (on_device_) on_device_ = device_->load(problem);
      subspace_.begin(on_device_ ? device_ : nullptr);
      residual = look_anew(problem);
      continue;
    }
    const bool gives_up = !converged && pause_.length > longest_pause;
    // A problem that will not converge to the tolerance must not hold its events for ever.
    const bool events_are_due =
        converged || (residual.value <= event_gate && (gives_up || 2 * report.sweeps >= sweeps));
    if (events_are_due && !problem.hold_events) {
      const Index fired = fire_events(problem);
      report.events += fired;
      if (fired > 0) {
        residual = look_anew(problem);
        continue;
      }
    }
    if (converged || gives_up || report.sweeps >= sweeps) break;

    const Real before = residual.value;
    report.sweeps += sweep_once(problem, report.sweeps == 0, before, sweeps - report.sweeps);
    residual = look(problem);
    step_directly(problem, before, residual, report);
  }

  const bool gave_way_alone = softened && residual.value <= goal_;
  if (softened) {
    // Reported is how far the problem as it was asked is from its laws.
    redundant_.harden(problem);
    load(problem);
    residual = look(problem);
  }
  report.residual = residual.value;
  report.violation = residual.violation;
  report.converged = residual.value <= goal_;
  contradict_ = gave_way_alone && !report.converged;
  if (!std::isfinite(residual.value)) {
    problem.lambda.setZero();
    problem.delta = problem.d_free;
  }
  return report;
}

}  // namespace sutura
