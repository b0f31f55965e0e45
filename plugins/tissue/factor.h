// Cholesky factors of a tissue's system matrix, behind one interface: CHOLMOD (supernodal, fast,
// GPL) or Eigen (simplicial, permissive). No type of either appears here.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "block_matrix.h"
#include "sutura/device.h"
#include "sutura/growing.h"

namespace sutura {
class Cache;
}

namespace sutura::tissue {

enum class FactorBackend { cholmod, eigen };

/// True if this build contains it.
bool has_backend(FactorBackend backend);
/// cholmod where it is built in, else eigen.
FactorBackend default_backend();

/// In which order the free nodes are eliminated, and where each block of A goes. Made once per
/// pattern and set of fixed nodes; immutable, shared by every factor made from it.
class FactorPlan;

/// `fixed`: per node, nonzero if prescribed (its rows and columns are left out); empty: none is.
/// `candidates`: free nodes to be eliminated last, in this order, so that the factor knows their
/// compliance (see Factor::candidate_compliance); fixed nodes among them are skipped. `cache`:
/// where one for the same pattern may be, or null.
std::shared_ptr<const FactorPlan> make_factor_plan(std::shared_ptr<const NodePattern> pattern,
                                                   std::span<const char> fixed,
                                                   std::span<const Index> candidates,
                                                   FactorBackend backend, Cache* cache = nullptr);

class Factor {
 public:
  /// Of a compliance that is asked for in the step: they share a pass over the factor, and there is
  /// work space for as many from the start.
  static constexpr Index columns_at_once = 16;

  virtual ~Factor() = default;
  /// A has the pattern of the plan. False if the matrix is not positive
  /// definite or not finite: the factor must then not be used until a later call succeeds.
  virtual bool factorise(const NodeMatrix& A) = 0;
  /// columns <- A^-1 columns, 3 nodes x any. Fixed nodes answer zero whatever they are given.
  /// Not to be called from two workers at once: the work space belongs to the factor.
  virtual void solve(Eigen::Ref<MatX> columns) const = 0;
  /// C = (A^-1) over the candidates of the plan (3 count square, order of `candidates_of`): the
  /// inverse of the last Schur block L_ss L_ss^T. It is the upper left corner of C, which grows if
  /// it has to and keeps its memory.
  virtual void candidate_compliance(MatX& C) const = 0;
  /// As `solve`, to the accuracy of single precision where the backend can do that faster: a solve
  /// is bound by reading L, which is then half as long. For preconditioning.
  virtual void solve_roughly(Eigen::Ref<MatX> columns) const { solve(columns); }
  /// The factor itself, as long as it lives and nothing is factorised anew, and in single precision
  /// too after keep_rough. False if the backend has no supernodes.
  virtual bool supernodes(SupernodalFactor&) const { return false; }
  /// Asks for what solve_roughly needs, to be made by every factorise from now on.
  virtual void keep_rough() {}
};

/// The same with other candidates. The rest keeps its order, whose quality does not suffer: a
/// separator remains one. Much cheaper than a new plan, and needs nothing but the old one.
std::shared_ptr<const FactorPlan> with_candidates(const FactorPlan& plan,
                                                  std::span<const Index> candidates);

/// Those that are free, in their order.
std::span<const Index> candidates_of(const FactorPlan& plan);

/// Symbolic analysis; `backend` as in the plan.
std::unique_ptr<Factor> make_factor(std::shared_ptr<const FactorPlan> plan);

}  // namespace sutura::tissue
