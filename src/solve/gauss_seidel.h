// Block Gauss-Seidel, with events and a direct step.
// docs/theory/solver.md.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "solve/law_residual.h"
#include "solve/linear_rows.h"
#include "solve/redundant_rows.h"
#include "solve/subspace_step.h"
#include "sutura/constraints.h"
#include "sutura/device.h"

namespace sutura {

enum class Acceleration {
  none,
  nncg,     ///< nonlinear conjugate gradient over sweeps (Silcowitz-Hansen, Niebe, Erleben 2010)
  subspace  ///< direct solve over the free directions once it is cheaper than the sweeps left
};

struct GaussSeidelOptions {
  /// Of the law residual, in units of the blocks. What is solved for a pass (`hold_events`) may end
  /// at a thousand times that, of the units and of what it begins with.
  Real tolerance = 1e-9;
  Index sweeps = 1000;     ///< budget
  std::uint64_t seed = 1;  ///< of the order of blocks
  Acceleration acceleration = Acceleration::subspace;
};

class BlockGaussSeidel {
 public:
  explicit BlockGaussSeidel(GaussSeidelOptions options = {}) : options_(options) {}
  GaussSeidelOptions& options() { return options_; }
  /// Sweeps there from now on; null: here.
  void set_device(SweepDevice* device) { device_ = device; }
  /// Why the last solve swept here although it has a device; empty if it did not.
  const std::string& trouble() const { return trouble_; }

  SolveReport solve(ConstraintProblem& problem);

 private:
  /// Law residual at which a solve ends that begins with `before`.
  Real goal_of(const ConstraintProblem& problem, Real before) const;
  /// By the forces it begins with.
  bool is_solved(ConstraintProblem& problem);
  /// Solves `others_`, and puts back all. True if more sweeps would not help.
  bool solve_others(ConstraintProblem& problem, SolveReport& report);
  /// Sweeps and direct steps until every block obeys its law, or the budget is spent. After `firm`
  /// sweeps rows that repeat each other give way.
  SolveReport iterate(ConstraintProblem& problem, Index sweeps, Index firm);
  void begin(ConstraintProblem& problem);
  void load(ConstraintProblem& problem);
  Residual look(ConstraintProblem& problem);
  Residual look_anew(ConstraintProblem& problem);
  Index sweep_once(ConstraintProblem& problem, bool first, Real residual, Index most);
  void step_directly(ConstraintProblem& problem, Real before, Residual& residual,
                     SolveReport& report);
  void shuffle();
  void sweep(ConstraintProblem& problem);
  Index sweep_on_device(ConstraintProblem& problem, Real residual, Index most);
  void conjugate(ConstraintProblem& problem);
  bool direct_step_pays(const ConstraintProblem& problem, Index free, Real before, Real now) const;

  /// Sweeps between one direct step and the next: longer each time that one has not brought the
  /// residual well below the best so far. (Below that of the sweep before it would not do: sweeps
  /// may undo what direct steps find, again and again.)
  struct Pause {
    Index left = 0, length = 1;
    Real best = std::numeric_limits<Real>::infinity();
  };

  GaussSeidelOptions options_;
  Pause pause_;
  Real goal_ = 0;  ///< of this solve; 0: not known yet
  Compliance compliance_;
  SubspaceStep subspace_;
  LinearRows linear_;
  ConstraintProblem others_;  ///< without the rows that are linear
  RedundantRows redundant_;
  bool contradict_ = false;  ///< rows that repeat each other, and are obeyed as far as they allow
  std::uint64_t random_ = 0;
  std::vector<std::size_t> order_;
  SweepDevice* device_ = nullptr;
  bool on_device_ = false;  ///< this solve, as long as the device answers
  std::vector<std::uint32_t> orders_;
  std::string trouble_;
  GrowingVec lambda_plus_;
  GrowingVec before_, search_;  // NNCG
  Real last_gradient_ = 0;
};

}  // namespace sutura
