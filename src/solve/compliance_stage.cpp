#include "solve/compliance_stage.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "solve/compliance.h"

namespace sutura {

void ComplianceStage::run(std::span<const Body* const> bodies, ConstraintProblem& problem, Real dt,
                          ComplianceForm form, const SolveReport& last,
                          std::span<ComplianceReport> reports) {
  const Index n = problem.rows();
  in_W_.assign(static_cast<std::size_t>(n), false);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    asked_ = bodies[i];
    problem.chains[i].clear();
    reports[i].as_operator = false;
    reports[i].assembled_count = reports[i].operator_count = 0;
    if (problem.bodies[i].size() == 0 ||
        bodies[i]->chain_compliance(problem.bodies[i], dt, problem.chains[i]))
      continue;
    for (const Index row : problem.bodies[i].row) in_W_[static_cast<std::size_t>(row)] = true;
  }
  always_ = std::count(in_W_.begin(), in_W_.end(), true);

  bool any_operator = false, any_assembled = always_ > 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (problem.chains[i].empty()) continue;
    count(problem, i, last, reports[i]);
    reports[i].as_operator = form == ComplianceForm::automatic
                                 ? reports[i].operator_count < reports[i].assembled_count
                                 : form == ComplianceForm::as_operator;
    (reports[i].as_operator ? any_operator : any_assembled) = true;
  }
  if (any_operator && !any_assembled) {
    problem.W.resize(0, 0);
    return;
  }
  problem.W.setZero(n, n);
  bool mirror = false;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (problem.chains[i].empty() || reports[i].as_operator) continue;
    chain_.prepare(problem, problem.chains[i], problem.bodies[i]);
    chain_.add_lower_triangle(problem.W);
    problem.chains[i].clear();
    mirror = true;
  }
  if (mirror) mirror_lower_triangle(problem.W);
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (problem.bodies[i].size() > 0 && !reports[i].as_operator && reports[i].assembled_count == 0)
      (asked_ = bodies[i])->add_compliance(problem.bodies[i], dt, problem.W);
}

/// Expected multiplications, in the two forms, of all that differs between them
/// (docs/theory/solver.md). A count and not a time: a run must not depend on the machine. Its unit
/// is a multiplication in a long column of W; measured once (solver bench), those in a 6 x 6 block
/// take 1.5 of it, those of a matrix-vector product half, and picking an entry out of W for the
/// direct step 4.
void ComplianceStage::count(const ConstraintProblem& problem, std::size_t body,
                            const SolveReport& last, ComplianceReport& report) const {
  const BodyRows& rows = problem.bodies[body];
  const Real t = static_cast<Real>(problem.chains[body].size()), r = static_cast<Real>(rows.size()),
             entries = static_cast<Real>(rows.node.size()), nodes = entries / r;
  // Blocks of this body, and the rows of a dense W without and with it.
  Real blocks = 0, without = static_cast<Real>(always_), with = without;
  Index before = -1;
  std::size_t block = 0;
  for (const Index row : rows.row) {
    while (block + 1 < problem.blocks.size() && problem.blocks[block + 1].first_row <= row) ++block;
    if (static_cast<Index>(block) != before) ++blocks;
    before = static_cast<Index>(block);
    if (!in_W_[static_cast<std::size_t>(row)]) ++with;
  }
  const Real dense = with * with - without * without;  // one look at what this body adds to W
  // What the solve will do, if it is like the last one: at least one look at the residual.
  const Real sweeps = static_cast<Real>(last.sweeps),
             looks = 1 + 2 * static_cast<Real>(last.direct_solves),
             matrices = static_cast<Real>(last.factorisations);

  constexpr Real in_block = 1.5, in_product = 0.5, picked = 4;
  // All pairs of rows: every force is carried to the first node, every row looks at every other.
  const Real pairs = r * 18 * t + 3 * r * entries;
  report.assembled_count =
      in_block * pairs + (sweeps + in_product * looks + picked * matrices) * dense;

  const Real levels =
      std::bit_width(std::bit_ceil(std::max(static_cast<std::uint64_t>(t), std::uint64_t{1}))) - 1;
  const Real product = 144 * t + 12 * entries;
  const Real visit = 72 * levels + 72 * (nodes - 1) + 144 * nodes;
  const Real tree = sweeps > 0 ? 216 * t : 0;
  report.operator_count = in_block * (72 * nodes * r + tree +
                                      sweeps * (blocks * visit + 12 * entries + product + 144 * t) +
                                      looks * product + matrices * pairs);
}

}  // namespace sutura
