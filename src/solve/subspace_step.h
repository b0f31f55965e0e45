// The direct step of the solver. In its present mode every law has a tangent (law.h,
// FreeDirections); the rows that are free on it form one linear system, solved at once:
//
//   lambda = base + move y,   test^T (W lambda + d_free) + gap + compliance y = 0.
//
// Sweeps find the modes, this finds the forces (Morales, Nocedal, Smelyanskiy 2008; Silcowitz,
// Niebe, Erleben 2010). It is what makes a stitch solvable: a free thread moves almost as a rigid
// body, W has a few huge modes that all path rows share, and sweeps alone would need thousands of
// visits to find the differences.
#pragma once

#include <vector>

#include "solve/law_residual.h"
#include "sutura/constraints.h"
#include "sutura/device.h"

namespace sutura {

class SubspaceStep {
 public:
  /// A new problem: no factor of the last one is of use. `device`: it has the problem, and solves
  /// large systems; null: all of them are solved here.
  void begin(SweepDevice* device = nullptr);

  /// Takes the tangents of all laws at the present lambda and delta. Returns the number of free
  /// directions.
  Index gather(const ConstraintProblem& problem, Compliance& compliance);

  /// Newton over the tangents: blocks take new ones after each solve. Rows that may repeat others
  /// are damped, the less the nearer it is to the solution (docs/theory/solver.md). All of them may
  /// change their state at first. That is fast but may cycle: whenever no fewer are in the wrong
  /// state than before, only two thirds as many may change, those with the largest residual (block
  /// pivoting: Judice and Pires 1994). If that does not end either and `may_walk`, a slower walk
  /// from where it started. Leaves the best point met. lambda must be admissible for every law (as
  /// it is after a sweep); `residual` and lambda_plus are those of natural_map before and after.
  Residual newton(ConstraintProblem& problem, Compliance& compliance, Residual residual,
                  Real tolerance, GrowingVec& lambda_plus, SolveReport& report, bool may_walk);

 private:
  static constexpr Real undamped = 1e-12;  ///< what rounding asks for
  struct Entry {
    Index row;
    Real move, test;
    bool operator==(const Entry&) const = default;
  };
  struct Direction {
    std::size_t first, end;  // entries
    std::size_t block;
    int index;  // within its block
    bool operator==(const Direction&) const = default;
  };
  struct System {
    std::vector<Entry> entries;
    std::vector<Direction> directions;
    std::vector<Real> compliance;  // per direction: max_block_dim values, its column
    bool operator==(const System&) const = default;
  };

  /// What each law asks for if its block answers a force alike in all directions, by the mean of
  /// its own compliance: a pair of force and delta on its graph, and its state. With the compliance
  /// itself a touch that rests beyond its friction would be asked to open instead of to slip
  /// wherever friction lifts it, and to rest again when it has opened.
  void ask(const ConstraintProblem& problem, Compliance& compliance);
  /// At what the law has been asked.
  void take_tangent(const ConstraintProblem& problem, Compliance& compliance, std::size_t block);
  /// New tangents for blocks whose state is that of their tangent, and for the `most` of the others
  /// whose residual is largest. Returns how many others there are.
  std::size_t change_states(const ConstraintProblem& problem, Compliance& compliance,
                            std::size_t most);
  void collect(const ConstraintProblem& problem);
  bool unchanged() const {
    return factored_ && factored_damping_ == damping_ && now_ == factored_with_;
  }
  /// lambda <- the solution on the tangents, delta <- W lambda + d_free. False if there is none.
  bool solve(ConstraintProblem& problem, Compliance& compliance, SolveReport& report);
  void assemble(const ConstraintProblem& problem, Compliance& compliance);
  /// What is added to the diagonal of the system, which is scaled to one.
  Real damping_of(const ConstraintProblem& problem, Index direction) const;
  bool factorise(const ConstraintProblem& problem);
  void find_scales(const ConstraintProblem& problem);
  void apply(ConstraintProblem& problem) const;
  /// From lambda = base: y, lambda and delta. False if the device cannot do it.
  bool solve_on_device(ConstraintProblem& problem);
  /// Likewise. False if there is no solution.
  bool solve_here(ConstraintProblem& problem, Compliance& compliance, SolveReport& report);
  bool is_solved(const ConstraintProblem& problem) const;
  /// test^T delta + gap of one direction.
  Real left_of(const ConstraintProblem& problem, Index direction) const;

  /// Active-set walk: solves on the tangents, goes towards the solution up to the first limit met,
  /// clamps what met it; once nothing is met, lets go the one clamped block that most wants to. For
  /// laws without coupling of normal and tangent this descends in energy and must end (Nocedal and
  /// Wright 2006, section 16.5).
  void walk(ConstraintProblem& problem, Compliance& compliance, Real tolerance,
            GrowingVec& lambda_plus, SolveReport& report);
  /// The tangent of a block at its force, with the delta that lets it rest there if the law allows.
  void hold(const ConstraintProblem& problem, Compliance& compliance, const GrowingVec& lambda,
            std::size_t block);
  /// Whether the block may have this force on its present tangent.
  bool admissible(const ConstraintProblem& problem, Compliance& compliance,
                  const GrowingVec& lambda, std::size_t block) const;
  void keep_best(const ConstraintProblem& problem, const Residual& residual);

  std::vector<FreeDirectionsView> tangents_;  // per block
  std::vector<Mode> states_;                  // per block, that of the tangent
  std::vector<Mode> asked_state_;             // per block
  GrowingVec asked_, asked_delta_;
  std::vector<std::size_t> changing_;         // blocks
  std::vector<RowCombination> combinations_;  // per direction
  GrowingVec base_;
  System now_, factored_with_;
  Real damping_ = undamped, factored_damping_ = undamped;  ///< of rows that may repeat others
  bool symmetric_ = true, factored_ = false;
  MatX matrix_;  // the leading part holds the system, then its factor
  Real asked_of_system_ = 0;
  GrowingVec gap_, scale_, y_, column_, best_lambda_, start_lambda_, walk_from_, walk_way_;
  Residual best_;
  SweepDevice* device_ = nullptr;
  struct Sent {  // what the device is told of a system
    std::vector<std::int32_t> first, row, first_of_block;
    std::vector<Real> move, test, compliance;
    TangentAnswer answer;
  } sent_;
  GrowingMat LU_;           // where the system is not symmetric
  std::vector<int> swaps_;  // of its rows
  std::vector<Real> block_residual_, stops_;
};

}  // namespace sutura
