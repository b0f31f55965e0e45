// Which irreversible events a step has to fire, by a solver that shares neither order nor start
// with the one of the scene.
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string_view>

#include "../../plugins/suturing/path_friction_law.h"
#include "../../plugins/suturing/puncture_law.h"
#include "solve/gauss_seidel.h"
#include "solve/reference_solver.h"
#include "step_checks.h"

namespace sutura::testing {
namespace {

constexpr Real fine = 1e-8;

bool same_events(const ConstraintProblem& a, const ConstraintProblem& b) {
  for (std::size_t i = 0; i < a.blocks.size(); ++i)
    if (a.blocks[i].law->event != nullptr && a.blocks[i].mode != b.blocks[i].mode) return false;
  return true;
}

/// The same laws without their events: what is due can then be looked at.
const LawOperations* without_events(const LawOperations* law) {
  static std::map<std::string_view, std::unique_ptr<LawOperations>> copies;
  auto& copy = copies[law->name];
  if (!copy) {
    copy = std::make_unique<LawOperations>(*law);
    copy->event = nullptr;
  }
  return copy.get();
}

bool due(const ConstraintProblem& p, std::size_t i, const LawOperations* law, Mode& mode) {
  const ConstraintBlock& b = p.blocks[i];
  mode = b.mode;
  return law->event != nullptr && law->event(p.block_params(b), p.delta.data() + b.first_row, &mode,
                                             p.lambda.data() + b.first_row);
}

/// How far the forces of a block are from the threshold of its event, in units of the block.
Real distance_from_event(const ConstraintProblem& p, const ConstraintBlock& b) {
  const VecX l = p.lambda.segment(b.first_row, b.law->dim),
             d = p.delta.segment(b.first_row, b.law->dim);
  if (std::string_view(b.law->name) == PunctureLaw::name) {
    const auto& q = *static_cast<const PunctureLaw::Params*>(p.block_params(b));
    return std::max((q.puncture_force - q.normal.dot(l.head<3>())) / b.units.force,
                    std::abs(q.normal.dot(d.head<3>())) / b.units.length);
  }
  const auto& q = *static_cast<const PathFrictionLaw::Params*>(p.block_params(b));
  return std::max((q.static_level - std::abs(l[0])) / b.units.force,
                  std::abs(std::abs(d[0]) - q.stick_slip) / b.units.length);
}

/// Round by round, event sets side by side, both solvers at 1e-8. `reference` is the answer that
/// differs from `solved`.
EventCheck explain(const ConstraintProblem& start, const ConstraintProblem& solved,
                   const ConstraintProblem& reference) {
  using Verdict = EventCheck::Verdict;
  EventCheck out;
  ConstraintProblem a = start, b = start;
  b.lambda.setZero();
  for (ConstraintProblem* p : {&a, &b})
    for (ConstraintBlock& block : p->blocks) block.law = without_events(block.law);
  // The block in question that comes closest to its threshold in any round: an event on the edge
  // may decide all that follow.
  Real nearest = INFINITY;
  std::string name;
  for (int round = 0; round < 20; ++round) {
    const SolveReport first = BlockGaussSeidel({.tolerance = fine, .sweeps = 5000}).solve(a);
    const SolveReport second = ReferenceSolver({.tolerance = fine}).solve(b);
    if (!first.converged || !second.converged) {
      out.verdict = Verdict::unsolved;
      return out;
    }
    Real apart = 0;
    for (const ConstraintBlock& block : a.blocks)
      apart =
          std::max(apart, (a.lambda - b.lambda).segment(block.first_row, block.law->dim).norm() /
                              block.units.force);
    if (apart > 1e-4) {
      out.verdict = Verdict::several;
      out.text = "forces apart by " + std::to_string(apart);
      return out;
    }
    bool any = false;
    for (std::size_t i = 0; i < start.blocks.size(); ++i) {
      const LawOperations* law = start.blocks[i].law;
      if (law->event == nullptr) continue;
      Mode mode = 0;
      const bool due_a = due(a, i, law, mode), due_b = due(b, i, law, mode);
      if (due_a != due_b || solved.blocks[i].mode != reference.blocks[i].mode) {
        const Real distance = distance_from_event(a, a.blocks[i]);
        if (distance < nearest) nearest = distance, name = law->name;
      }
      any = any || due_a;
    }
    if (!any) break;
    for (std::size_t i = 0; i < start.blocks.size(); ++i) {
      Mode mode = 0;
      if (due(a, i, start.blocks[i].law, mode)) a.blocks[i].mode = b.blocks[i].mode = mode;
    }
  }
  // A threshold that is met as well as the tolerances of the step can tell.
  out.verdict = nearest < 1e-4 ? Verdict::undecided : Verdict::wrong;
  out.text = name + ", from its threshold by " + std::to_string(nearest);
  return out;
}

}  // namespace

PunctureCount punctures(const ConstraintProblem& start, const ConstraintProblem& solved) {
  PunctureCount out;
  for (std::size_t i = 0; i < solved.blocks.size(); ++i) {
    const ConstraintBlock& b = solved.blocks[i];
    if (std::string_view(b.law->name) != PunctureLaw::name || b.mode == start.blocks[i].mode)
      continue;
    const auto& q = *static_cast<const PunctureLaw::Params*>(solved.block_params(b));
    if (!q.hold)
      ++out.exits;  // nothing in front of the tip is left to hold it
    else if ((q.normal + q.axis).norm() < 1e-9)
      ++out.layers;  // a layer has no surface but the needle's axis
    else
      ++out.entries;
  }
  return out;
}

EventCheck check_events(const ConstraintProblem& start, const ConstraintProblem& solved) {
  EventCheck out;
  ConstraintProblem reference = start;
  reference.lambda.setZero();
  const SolveReport report = ReferenceSolver({.tolerance = fine}).solve(reference);
  if (!report.converged)
    out.verdict = EventCheck::Verdict::unsolved;
  else if (!same_events(solved, reference))
    out = explain(start, solved, reference);
  out.events = report.events;
  return out;
}

}  // namespace sutura::testing
