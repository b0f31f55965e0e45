// The stage "compliance": W of the assembled bodies, chains as operators, and which of the two a
// chain becomes.
#pragma once

#include <span>
#include <vector>

#include "solve/chain_operator.h"
#include "sutura/constraints.h"

namespace sutura {

class ComplianceStage {
 public:
  /// Fills problem.W and problem.chains. `last`: how the step before was solved, from which the
  /// cost of this one is expected. `reports`: one per body.
  void run(std::span<const Body* const> bodies, ConstraintProblem& problem, Real dt,
           ComplianceForm form, const SolveReport& last, std::span<ComplianceReport> reports);
  /// The body that was asked last.
  const Body* asked() const { return asked_; }

 private:
  void count(const ConstraintProblem& problem, std::size_t body, const SolveReport& last,
             ComplianceReport& report) const;

  ChainOperator chain_;
  const Body* asked_ = nullptr;
  std::vector<char> in_W_;  // per row: in W whatever chains become
  Index always_ = 0;        // how many of those
};

}  // namespace sutura
