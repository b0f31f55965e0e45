// Rows: what constraint sources build, what a constraint solver solves, what sources read back.
// lambda is a force in newtons (moment in N m for rotational rows), delta and d_free are in metres
// (rad), W in m/N.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sutura/body.h"
#include "sutura/growing.h"
#include "sutura/law.h"

namespace sutura {

class Archive;

/// Directions of the rows of a block, one per row.
using Directions = Eigen::Matrix<Real, Eigen::Dynamic, 3, Eigen::ColMajor, max_block_dim, 3>;

/// Names a block across steps, so that its lambda and mode survive. Stable under resampling: made
/// of what the block is about (a path sample, a contact), never of node numbers.
struct Key {
  std::uint64_t value = 0;
  auto operator<=>(const Key&) const = default;
};
inline Key make_key(Index source_id, std::uint64_t local) {
  return {(static_cast<std::uint64_t>(source_id) << 40) | local};
}
inline Index source_of(Key key) {
  return static_cast<Index>(key.value >> 40);
}
inline std::uint64_t local_of(Key key) {
  return key.value & ((std::uint64_t{1} << 40) - 1);
}

/// Index of a block within one step.
struct BlockId {
  Index index = -1;
  bool valid() const { return index >= 0; }
};

/// The scales against which a block's residual is measured: a converged block is wrong by less than
/// tolerance * force and tolerance * length.
struct BlockUnits {
  Real force = 0.1;    ///< N
  Real length = 1e-4;  ///< m
};

struct ConstraintBlock {
  const LawOperations* law = nullptr;
  Index first_row = 0;
  std::size_t params = 0;  ///< byte offset into ConstraintProblem::params
  Key key;
  BlockUnits units;
  Mode mode = 0;
  bool redundant = false;  ///< see ConstraintBuilder::mark_redundant
  Real idle_beyond = std::numeric_limits<Real>::infinity();  ///< see ConstraintBuilder::may_idle
  bool timed = false;                                        ///< see ConstraintBuilder::time_event
  Real precision = std::numeric_limits<Real>::infinity();    ///< see ConstraintBuilder::keep_within
  Real violation = 0;      ///< on exit of a solve: how far from its law (m)
  Vec3 at = Vec3::Zero();  ///< where it acts (m)
  Eigen::Matrix<Real, 3, max_block_dim> axes = decltype(axes)::Zero();  ///< force = axes * lambda
};

/// One step's problem: delta = W lambda + d_free, and a law per block.
class ConstraintProblem {
 public:
  std::vector<ConstraintBlock> blocks;
  std::vector<std::max_align_t> params;
  GrowingVec gap;     ///< per row: violation at the guess, as the sources measured it
  GrowingVec d_free;  ///< per row: what the linear answer leaves of the gap without lambda
  GrowingVec lambda;  ///< per row; on entry the warm start, on exit the solution
  GrowingVec delta;   ///< per row; on exit W lambda + d_free
  /// Rows x rows, the sum over the bodies: for a solver. The problem of a Simulation has none, as
  /// its solver is given one without the blocks that are idle.
  GrowingMat W;
  std::vector<BodyRows> bodies;  ///< H, one per body of the simulation

  /// Events must wait: lambda is that of a guess.
  bool hold_events = false;

  Index rows() const { return gap.size(); }
  const void* block_params(const ConstraintBlock& b) const {
    return reinterpret_cast<const std::byte*>(params.data()) + b.params;
  }
  /// Force on the first-coupled body, in world axes (N).
  Vec3 block_force(const ConstraintBlock& b) const {
    return b.axes.leftCols(b.law->dim) * lambda.segment(b.first_row, b.law->dim);
  }
};

/// Lets sources append blocks. Used between ConstraintBuilder::begin and finish, once per guess.
class ConstraintBuilder {
 public:
  /// `bodies`: all bodies of the simulation, in row order of `problem.bodies`.
  ConstraintBuilder(ConstraintProblem& problem, std::vector<const Body*> bodies);

  /// Where known keys take lambda and mode from.
  enum class Warm { step_before, pass_before, best_guess };
  void begin(Warm warm = Warm::step_before);
  /// Assembles H; warm-starts known keys.
  void finish();
  /// What the problem holds now is the end of a step.
  void accept();
  /// What the problem holds now is that of the best guess of this step so far.
  void mark_best_guess();

  /// gap: violation at the guess. `mode` is where a block begins whose key was not there before.
  template <Law L>
  BlockId add(Key key, const typename L::Params& params, const BlockVector<L::dim>& gap,
              Mode mode = 0, BlockUnits units = {}) {
    return add_block(&law_operations<L>, key, &params, gap.data(), mode, units);
  }
  /// Other blocks may say the same as this one, or contradict it, as touches that lie close
  /// together do. The solver may then leave a small error in one pass, which the next one takes
  /// back.
  void mark_redundant(BlockId block);
  /// This block carries nothing while its first row is open, as that of a touch. A pass leaves it
  /// out as long as it carries nothing and is open by more than `beyond` (m), and takes it in where
  /// the answer of the bodies closes it.
  void may_idle(BlockId block, Real beyond);
  /// This block is to obey its law to so much (m) at the end of the step, where that is less than
  /// what the scene allows: what it misses adds up over steps.
  void keep_within(BlockId block, Real precision);
  /// When the event of this block happens matters: the step is divided there, as far as it may be.
  void time_event(BlockId block);
  /// The force with which a block begins whose key was not there before (N, one per row): of a
  /// touch that has been without rows for a while.
  template <int N>
  void begin_with(BlockId block, const BlockVector<N>& lambda) {
    const Index first = problem_.blocks[static_cast<std::size_t>(block.index)].first_row;
    std::copy_n(lambda.data(), N, first_lambda_.begin() + first);
  }
  /// Force of a row of the block with this key where known keys take theirs from (N); 0 if there
  /// was none. For stiffnesses that grow with it.
  Real known_force(Key key, Index row = 0) const;
  /// Likewise its mode, or `otherwise` if there was none. For what ends where a block has given
  /// way.
  Mode known_mode(Key key, Mode otherwise) const;
  /// Adds directions (dim x 3) * J to the rows of the block: the block's delta grows by
  /// directions * displacement of the point. A block may couple a body more than once.
  /// The first coupling decides where and on whom the block's force is drawn.
  void couple(BlockId block, const Body& body, const Directions& directions, const PointJacobian& J,
              const Vec3& at);

  /// What known keys will be given in the next step. Between steps.
  void archive(Archive& archive);

 private:
  BlockId add_block(const LawOperations* law, Key key, const void* params, const Real* gap,
                    Mode mode, BlockUnits units);
  struct Patch {        // one call of couple, on one body
    Index block, next;  // next patch of the same block, -1 at the end
    std::size_t body;
    int nodes;
    std::size_t first_node, first_value;  // values: dim x (nodes * width), column major
  };
  struct Known {
    Key key;
    std::string_view law;  ///< name; of a restored block in `restored_laws_`
    Index first;
    Mode mode;
  };
  /// Blocks by key, with their lambda and mode.
  struct Memory {
    std::vector<Known> blocks;
    std::vector<Real> lambda;
    /// `next`: what it will be asked for.
    void remember(const ConstraintProblem& problem, Warm next);
    const Known* find(Key key) const;
    void archive(Archive& archive, std::set<std::string>& laws);
  };
  void gather_rows(std::size_t body);
  /// Where known keys take theirs from in this problem.
  const Memory& memory() const;

  ConstraintProblem& problem_;
  std::vector<const Body*> bodies_;
  std::vector<Patch> patches_;
  std::vector<Index> patch_nodes_;
  std::vector<Real> patch_values_;
  std::vector<Index> first_patch_, last_patch_;  // per block
  std::vector<Real> gap_, first_lambda_;
  Memory step_before_, pass_before_, best_guess_;
  Warm warm_ = Warm::step_before;
  std::set<std::string> restored_laws_;  ///< names that restored blocks view
  std::vector<Index> merged_nodes_;
  std::vector<Real> merged_values_;
};

/// What sources read in `commit`.
class SolvedBlocks {
 public:
  explicit SolvedBlocks(const ConstraintProblem& problem) : problem_(problem) {}
  const ConstraintBlock& block(BlockId id) const {
    return problem_.blocks[static_cast<std::size_t>(id.index)];
  }
  auto lambda(BlockId id) const {
    return problem_.lambda.segment(block(id).first_row, block(id).law->dim);
  }
  auto delta(BlockId id) const {
    return problem_.delta.segment(block(id).first_row, block(id).law->dim);
  }
  Mode mode(BlockId id) const { return block(id).mode; }
  Vec3 force(BlockId id) const { return problem_.block_force(block(id)); }

 private:
  const ConstraintProblem& problem_;
};

/// A component that makes rows. Stages detect, build and commit of the step.
class ConstraintSource {
 public:
  static constexpr const char* interface_name = "ConstraintSource";
  virtual ~ConstraintSource() = default;
  /// Finds candidates. With `build` after each pass, so in a step it runs at several guesses; what
  /// a step is about (which surface, which sample) is best decided in pass 0 and kept.
  virtual void detect(const StepContext&) {}
  /// Of what `detect` has looked at: how much of the straight way from the start of the step to the
  /// guess may be gone, 1 if all of it; or of that from the guess that it was told to keep, if that
  /// is free. No guess goes further, whatever the solver finds.
  virtual Real free_way() const { return 1; }
  /// All that there is has come to the present guess on ways that are free. What slides round a
  /// corner goes on from here, where the straight way from the start of the step is barred.
  virtual void keep_guess() {}
  /// Appends blocks, with their violation at the current configuration of the bodies. The order of
  /// blocks must depend on nothing but the state.
  virtual void build(const StepContext& context, ConstraintBuilder& builder) = 0;
  /// A solved guess is about to be taken. True if what this source took for given in it does not
  /// hold, as that a knot is rigid, and is given up: the step is then taken once more from its
  /// start.
  virtual bool revise(const StepContext&, const SolvedBlocks&) { return false; }
  /// After `correct`: the only place where topology and the number of rows may change.
  virtual void commit(const StepContext&, const SolvedBlocks&) {}
  /// The attribute that decides how many rows it makes, to be named where they are too many.
  virtual const char* rows_attribute() const { return nullptr; }
  /// Why the result of the last step cannot be trusted, although the step is solved; empty if it
  /// can.
  virtual std::string fault() const { return {}; }
  /// Of what the last `detect` has looked at: false where something turns so far in the step that a
  /// straight way says too little of where it goes. Such a step is too long, and is divided.
  virtual bool knows_way() const { return true; }
};

struct SolveReport {
  Index sweeps = 0;
  Index direct_solves = 0;   ///< subspace steps
  Index events = 0;          ///< fired during the step
  Index factorisations = 0;  ///< of which with a new matrix
  Real residual = 0;         ///< law residual, in units of the blocks
  Real violation = 0;        ///< largest distance of a block from its law (m)
  bool converged = true;
};

/// Solves the problem in place (lambda, delta, modes). A component; GaussSeidel is the default.
class ConstraintSolver {
 public:
  static constexpr const char* interface_name = "ConstraintSolver";
  virtual ~ConstraintSolver() = default;
  virtual SolveReport solve(ConstraintProblem& problem) = 0;
  /// What went wrong in the last solve although there is a result, a sentence; empty if nothing
  /// did.
  virtual std::string trouble() const { return {}; }
};

}  // namespace sutura
