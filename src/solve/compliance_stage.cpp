#include "solve/compliance_stage.h"

#include <algorithm>
#include <bit>

#include "solve/compliance.h"

namespace sutura {

void ComplianceStage::run(std::span<const Body* const> bodies, ConstraintProblem& problem, Real dt, ComplianceForm form,
                          const SolveReport& last, std::span<ComplianceReport> reports) {
  const Index n = problem.rows();
  in_W_.assign(static_cast<std::size_t>(n), false);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    problem.chains[i].clear();
    reports[i].as_operator = false;
    reports[i].assembled_count = reports[i].operator_count = 0;
    if (problem.bodies[i].size() == 0 || bodies[i]->chain_compliance(problem.bodies[i], dt, problem.chains[i]))
      continue;
    for (const Index row : problem.bodies[i].row) in_W_[static_cast<std::size_t>(row)] = true;
  }
  always_ = std::count(in_W_.begin(), in_W_.end(), true);

  bool all_operators = always_ == 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (problem.chains[i].empty()) continue;
    count(problem, i, last, reports[i]);
    reports[i].as_operator = form == ComplianceForm::automatic
                                 ? reports[i].operator_count < reports[i].assembled_count
                                 : form == ComplianceForm::as_operator;
    all_operators = all_operators && reports[i].as_operator;
  }
  if (all_operators) {
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
      bodies[i]->add_compliance(problem.bodies[i], dt, problem.W);
}

/// Multiplications, in the two forms, of what differs between them.
void ComplianceStage::count(const ConstraintProblem& problem, std::size_t body, const SolveReport& last,
                            ComplianceReport& report) {
  const BodyRows& rows = problem.bodies[body];
  const Real t = static_cast<Real>(problem.chains[body].size()), r = static_cast<Real>(rows.size()),
             entries = static_cast<Real>(rows.node.size());
  report.assembled_count = r * 18 * t + 3 * r * entries;
  report.operator_count = 2 * report.assembled_count;
  (void)last;
}

}  // namespace sutura
