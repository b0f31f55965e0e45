// How a tissue solves A x = b: the interface its component calls, once or more per step.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "block_matrix.h"
#include "compliance.h"
#include "sutura/device.h"
#include "sutura/types.h"

namespace sutura {
class Archive;
class Cache;
class Registry;
}  // namespace sutura

namespace sutura::tissue {

/// What the solver did in this step.
struct TissueSolveReport {
  Index iterations = 0;      ///< of PCG, summed over all solves of the step; 0: direct
  Real residual = 0;         ///< |b - A x| / |b|, the worst of the step
  Index factor_age = 0;      ///< steps between the factorised matrix and this one
  Index adopted_at = -1;     ///< step at which the factor in use was adopted
  Index failed_factors = 0;  ///< factorisations that failed so far
  Index analyses = 0;        ///< orders of elimination chosen anew so far, not by a worker
  bool converged = true;
  bool stale = false;   ///< the factor is older than the policy allows: the worker is late
  std::string message;  ///< empty, or what went wrong: clauses, in the order of events

  /// Once per step, however many right-hand sides run into it.
  void complain(const std::string& clause) {
    if (message.find(clause) != std::string::npos) return;
    message += (message.empty() ? "" : "; ") + clause;
  }
};

/// All but the message and the number of analyses, which are of this process.
void archive(Archive& archive, TissueSolveReport& report);

class TissueSolver {
 public:
  static constexpr const char* interface_name = "TissueSolver";
  virtual ~TissueSolver() = default;

  /// Before the first step. `fixed`: per node, nonzero if prescribed; copied. `candidates`: nodes
  /// whose compliance will be asked for from the start; the others are learnt from `touch`.
  virtual void analyse(std::shared_ptr<const NodePattern> pattern, std::span<const char> fixed,
                       std::span<const Index> candidates) = 0;
  /// False: `prepare` may be given no rotations.
  virtual bool wants_rotations() const = 0;
  /// The matrix of this step (kept by reference until the next call, never written) and the
  /// rotation of the material around each node, from rest to there: the polar factor of the mean
  /// deformation gradient of the elements around it, weighted by volume. `same`: the matrix and the
  /// rotations of the call before, also of one before the state was saved.
  virtual void prepare(const NodeMatrix& A, std::span<const Mat3> rotations, Index step,
                       bool same = false) = 0;
  /// The next matrix has little to do with the last one (another length of step): what was made of
  /// older ones is of no use.
  virtual void renew() {}
  /// columns <- A^-1 columns to the tolerance of the solver, or until |b - A x| <= enough; fixed
  /// nodes answer zero.
  virtual void solve(Eigen::Ref<MatX> columns, Real enough = 0) = 0;
  /// Likewise, as `compliance` has it: with the factor in use.
  virtual void solve_as_compliance(Eigen::Ref<MatX> columns) = 0;
  /// Where it solves, if that is a device: it may make the matrix as well.
  virtual ConjugateGradientDevice* device() { return nullptr; }
  virtual Index nodes() const = 0;
  virtual bool is_fixed(Index node) const = 0;
  /// Constraints touch these nodes: their compliance will be asked for now, and probably in the
  /// next steps. Returns the number of columns that were solved for to know it.
  virtual Index touch(std::span<const Index> nodes) = 0;
  /// As of the factor in use, turned to now: exact for a direct solver, approximate (age,
  /// deformation) for an asynchronous one. C is empty if nothing is known.
  virtual NodeCompliance compliance() const = 0;
  /// W += scale H C H^T on a device, C that of `compliance`; false: here.
  virtual bool add_on_device(const SparseRows&, Real /*scale*/, Eigen::Ref<MatX> /*W*/) {
    return false;
  }
  virtual const TissueSolveReport& report() const = 0;
  /// After `analyse`.
  virtual void archive(Archive& archive) = 0;
};

/// What a tissue uses that names no solver: factorises every new matrix at once.
std::unique_ptr<TissueSolver> make_direct_solver(std::shared_ptr<Cache> cache = {});

/// The components of this room that implement TissueSolver.
void enrol_tissue_solvers(Registry& registry);

}  // namespace sutura::tissue
