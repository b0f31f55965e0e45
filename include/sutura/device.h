// What an accelerator (a GPU) does for the solvers, which stay what they are: they decide when a
// problem is solved, when events fire and what happens where a device is missing or lost.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

#include "sutura/constraints.h"
#include "sutura/growing.h"

namespace sutura {

/// Thrown out of a solve by a device that fails in a scene that does not let the CPU take over. The
/// sentence is for the person who runs the scene.
class DeviceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Blocks that are free on their tangents (solve/subspace_step.h), with the W of the problem that
/// was loaded: lambda = base + move y,  test^T (W lambda + d_free) + gap + compliance y = 0.
struct TangentSystem {
  std::span<const std::int32_t> first;  ///< entries of direction j: first[j] .. first[j + 1]
  std::span<const std::int32_t> first_of_block;  ///< per direction: the first one of its block
  std::span<const std::int32_t> row;             ///< per entry
  std::span<const Real> scale;  ///< per direction: of row and column, so that the diagonal is one
  std::span<const Real> gap;    ///< per direction
  std::span<const Real> compliance;    ///< max_block_dim per direction: its column in its block
  std::span<const Real> base, d_free;  ///< per row of the problem
  std::span<const Real> move, test;    ///< per entry
  Real regularisation = 0;             ///< added to the diagonal once it is scaled
};

struct TangentAnswer {
  std::vector<Real> numbers;
  /// y, and the scaled right-hand side, of `count` directions; delta of all rows.
  std::span<const Real> y(std::size_t count) const { return std::span(numbers).first(count); }
  std::span<const Real> right(std::size_t count) const {
    return std::span(numbers).subspan(count, count);
  }
  std::span<const Real> delta(std::size_t count) const {
    return std::span(numbers).subspan(2 * count);
  }
};

/// Sweeps of block Gauss-Seidel on a device, and its direct step.
class SweepDevice {
 public:
  static constexpr const char* interface_name = "SweepDevice";
  virtual ~SweepDevice() = default;
  /// Takes W, laws and parameters of a problem. False: the CPU shall do it, `why_not` says why.
  /// Throws DeviceError where it must not.
  virtual bool load(const ConstraintProblem& problem) = 0;
  /// One sweep for every blocks.size() entries of `orders`, from lambda, delta and the modes of the
  /// problem that was loaded; they are left at the result. False or throws as `load`; the problem
  /// is then as it was.
  virtual bool sweep(ConstraintProblem& problem, std::span<const std::uint32_t> orders) = 0;
  /// False also where the device has too few digits for it.
  virtual bool solve_tangents(const TangentSystem& system, TangentAnswer& answer) = 0;
  /// Sums are rounded more coarsely than on the CPU: delta is to be made again from lambda.
  virtual bool is_rough() const = 0;
  virtual const std::string& why_not() const = 0;
};

/// A Cholesky factor L L^T = P A P^T in dense supernodes, as CHOLMOD makes it. Supernode s holds
/// the columns first_column[s] .. first_column[s + 1] of L; its rows are row[first_row[s]] ..
/// row[first_row[s + 1]], of which the first are those columns; its numbers are dense, by columns,
/// from first_value[s] on.
struct SupernodalFactor {
  Index size = 0;
  std::span<const std::int32_t> first_column, first_row, first_value, row;
  std::span<const Real> value;
  std::span<const float> rough;      ///< the same numbers in single precision; may be empty
  std::vector<std::int32_t> row_of;  ///< position in L -> row of the full vector
};

/// Symmetric, one 3x3 block per pair of nodes; only i <= j, by rows, the diagonal block first.
struct NodeMatrixView {
  Index nodes = 0;
  std::span<const std::int32_t> row_start, column;
  const Real* values = nullptr;  ///< nine per block, by rows
};

/// Corotational linear tetrahedra (docs/theory/tissue.md), in the order in which they are summed.
struct TetElementsView {
  std::span<const std::int32_t> node;  ///< four per tet, ascending
  std::span<const std::int32_t> slot;  ///< ten per tet: its blocks 00 01 02 03 11 12 13 22 23 33
  std::span<const Real> gradient;      ///< nine per tet: of nodes 1, 2, 3; node 0: minus their sum
  std::span<const Real> volume;        ///< m^3
  std::span<const Real> moduli;        ///< two per tet: mu and lambda, times volume (N m)
};

/// Compliance between the unknowns of known nodes, three per node, symmetric, by columns.
struct KnownCompliance {
  Index id = -1;  ///< the same as long as columns are only added; -1: never the same
  const Real* C = nullptr;
  Index size = 0, stride = 0;
};

/// Rows of three numbers per node that they touch.
struct SparseRows {
  std::span<const std::int32_t> first;  ///< entries of row r: first[r] .. first[r + 1]
  std::span<const std::int32_t> place;  ///< per entry: which known node; -1: a fixed one
  std::span<const Real> value;          ///< three per entry
  std::span<const Index> row;           ///< of W
};

/// Conjugate gradients on a device: A of the step, preconditioned by an older factor turned with
/// the material, P^-1 = Q (L L^T)^-1 Q^T.
class ConjugateGradientDevice {
 public:
  static constexpr const char* interface_name = "ConjugateGradientDevice";
  struct Report {
    Index iterations = 0;
    Real residual = 0;  ///< |b - A x| / |b|
    bool converged = false;
  };
  static constexpr Index most_recent = 6;
  virtual ~ConjugateGradientDevice() = default;
  /// Before the first step, by the solver that will use it: false if another one has it already.
  virtual bool claim() = 0;

  // All of these: false where the CPU shall do it, `why_not` says why; DeviceError where it must
  // not.

  /// The matrix of the step. `fixed`: per node, nonzero where b is ignored and x zero.
  virtual bool set_matrix(const NodeMatrixView& A, std::span<const char> fixed) = 0;
  /// Elements whose forces and matrix are made there; `pattern` is that of the matrix.
  virtual bool set_elements(const TetElementsView& tets, const NodeMatrixView& pattern,
                            std::span<const char> fixed) = 0;
  /// `share` beta/(h + beta) of the strain at the start of the step is taken off; 0: none.
  virtual bool set_viscosity(const VecX& moved, Real share) = 0;
  /// The matrix of the step, from elements whose nodes have `moved` since rest (m): A <- scale K +
  /// diag(diagonal); force <- -dE/dx (N); rotations <- of the material around each node.
  virtual bool assemble(const VecX& moved, Real scale, const VecX& diagonal, VecX& force,
                        std::vector<Mat3>& rotations) = 0;
  /// force <- -dE/dx (N).
  virtual bool element_force(const VecX& moved, VecX& force) = 0;
  /// The numbers of the matrix that was assembled.
  virtual bool read_matrix(std::span<Real> values) = 0;
  virtual bool set_factor(const SupernodalFactor& factor) = 0;
  /// Q, per node.
  virtual bool set_turns(std::span<const Mat3> turns) = 0;
  /// Q from the rotations that were found with the matrix, and those of the factor that was sent.
  virtual bool find_turns(std::span<const Mat3> of_factor) = 0;
  /// Keeps these solutions instead of those it has kept, by columns, most_recent at most. `next`:
  /// which of them the next one replaces; their number: none yet.
  virtual bool keep(const Eigen::Ref<const MatX>& x, Index next) = 0;
  /// x <- A^-1 b, from the combination of the solutions it has kept that is best in the energy
  /// norm. Keeps this one too if it has converged and is not zero.
  virtual bool solve(const Eigen::Ref<const VecX>& b, Eigen::Ref<VecX> x, Real tolerance,
                     Index max_iterations, Report& report) = 0;
  /// entries <- those of the inverse of the matrix that was factorised, between unknowns of the
  /// full vector: `rows` down, `columns` across; zero for fixed ones. As exact as the factor that
  /// was sent.
  virtual bool entries_of_inverse(std::span<const Index> rows, std::span<const Index> columns,
                                  Eigen::Ref<MatX> entries) = 0;
  /// W += scale H C H^T. W is left as it was where the CPU shall do it.
  virtual bool add_compliance(const KnownCompliance& known, const SparseRows& rows, Real scale,
                              Eigen::Ref<MatX> W) = 0;
  virtual const std::string& why_not() const = 0;
};

}  // namespace sutura
