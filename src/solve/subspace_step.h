// The direct step of the solver. In its present mode every law has a tangent (law.h, FreeDirections); the rows that are
// free on it form one linear system, solved at once:
//
//   lambda = lambda_plus + move y,   test^T (W lambda + d_free) + gap + compliance y = 0.
//
// Sweeps find the modes, this finds the forces (Morales, Nocedal, Smelyanskiy 2008; Silcowitz, Niebe, Erleben 2010). It
// is what makes a stitch solvable: a free thread moves almost as a rigid body, W has a few huge modes that all
// path rows share, and sweeps alone would need thousands of visits to find the differences.
#pragma once

#include <Eigen/LU>
#include <vector>

#include "solve/law_residual.h"
#include "sutura/constraints.h"

namespace sutura {

class SubspaceStep {
 public:
  void begin();  ///< a new problem: no factor of the last one is of use

  /// Collects the free directions at (lambda_plus, the delta each block itself then sees). Returns their number.
  Index gather(const ConstraintProblem& problem, const DiagonalBlocks& diagonal,
               const VecX& lambda_plus);
  /// Same directions as at the last `solve`: its factor is kept.
  bool unchanged() const { return factored_ && same_; }
  /// lambda <- the solution on the tangents gathered, delta <- W lambda + d_free. False if no factor exists.
  bool solve(ConstraintProblem& problem, const VecX& lambda_plus);

  /// Steps (Newton over the tangents), as long as they get somewhere; leaves the best point met. `residual` and
  /// lambda_plus are those of natural_map before and after.
  Residual newton(ConstraintProblem& problem, const DiagonalBlocks& diagonal, Residual residual,
                  Real tolerance, VecX& lambda_plus, Index& direct_solves);

 private:
  struct Entry {
    Index row;
    Real move, test;
    bool operator==(const Entry&) const = default;
  };
  struct Direction {
    std::size_t first, end;  // entries
    Index block;
    int index;  // within its block
    bool operator==(const Direction&) const = default;
  };
  struct Tangents {
    std::vector<Entry> entries;
    std::vector<Direction> directions;
    std::vector<Real> compliance;  // per direction: max_block_dim values, its column
    bool operator==(const Tangents&) const = default;
  };
  void assemble(const ConstraintProblem& problem);
  bool factorise();

  Tangents now_, factored_with_;
  VecX gap_;
  bool symmetric_ = true, same_ = false, factored_ = false;
  MatX matrix_;  // capacity x capacity; the leading f x f part holds the system, then its factor
  VecX scale_, y_, column_, best_lambda_;
  Eigen::PartialPivLU<MatX> lu_;
};

}  // namespace sutura
