// A constraint law: a pure function of one block. delta = W lambda + d, d what is left without the
// block's own force, meets the law's graph of (delta, lambda); `project` returns that lambda.
//
//   struct Unilateral {                         // 0 <= delta  _|_  lambda >= 0
//     static constexpr int dim = 1;
//     static constexpr const char* name = "unilateral";
//     struct Params { };                        // copied as bytes
//     static void project(const BlockMatrix<1>& W, const BlockVector<1>& d, const Params&,
//                         Mode&, BlockVector<1>& lambda) { lambda = max(0, -d / W); }
//     static void free_directions(...)          // see below
//   };
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "sutura/types.h"

namespace sutura {

template <int N>
using BlockMatrix = Eigen::Matrix<Real, N, N>;
template <int N>
using BlockVector = Eigen::Matrix<Real, N, 1>;

/// Rows a block can have at most.
inline constexpr int max_block_dim = 6;

/// The state word of a law (open, stick, slip, ...); meaning is the law's own.
using Mode = std::uint8_t;

/// What `project` is given: `d` is the violation *without* the block's own lambda,
/// d = delta - W lambda (m).
///
/// What `free_directions` is given: a pair (delta, lambda) on the law's graph, as `project` left
/// it, and its mode. It answers with the tangent of the graph there, for the direct (subspace) step
/// of the solver: with y the `count` coordinates,
///     lambda + move * y      stays on the tangent, and
///     test^T * delta + gap + compliance * y = 0      must then hold for the delta of the system.
/// Stick and bilateral: move = test = identity. Clamped or open: none. Slipping contact with normal
/// n and slip direction t: move = n - mu t, test = n. A spring delta = -c lambda: move = test =
/// identity, gap = c lambda, compliance = c * identity.
template <int N>
struct FreeDirections {
  int count = 0;
  BlockMatrix<N> move = BlockMatrix<N>::Identity();    ///< N x count
  BlockMatrix<N> test = BlockMatrix<N>::Identity();    ///< N x count
  BlockVector<N> gap = BlockVector<N>::Zero();         ///< count (m)
  BlockMatrix<N> compliance = BlockMatrix<N>::Zero();  ///< count x count (m/N)
};

template <class L>
concept Law =
    // Parameters are copied as bytes into the problem: plain members, Vec3 and other fixed-size
    // Eigen vectors that need no special alignment.
    std::is_trivially_destructible_v<typename L::Params> &&
    (alignof(typename L::Params) <= alignof(std::max_align_t)) &&
    (L::dim >= 1) && (L::dim <= max_block_dim) &&
    requires(const BlockMatrix<L::dim>& W, const BlockVector<L::dim>& d,
             const typename L::Params& p, Mode& mode, BlockVector<L::dim>& lambda,
             FreeDirections<L::dim>& free) {
  {L::name};
  // lambda <- the solution of the block, from any lambda; mode <- the state it is in.
  {L::project(W, d, p, mode, lambda)};
  // The tangent of the graph at (delta, lambda); delta is passed where `d` stands here.
  {L::free_directions(d, p, mode, lambda, free)};
};

/// A law with events (something breaks, or breaks away) adds
///   static bool event(const Params&, const BlockVector<dim>& delta, Mode&,
///                     const BlockVector<dim>& lambda)
/// which changes the mode and returns true if the event is due. Called only on forces that are
/// converged and verified; nothing takes the change back within the step.
template <class L>
concept LawWithEvents = Law<L> &&
    requires(const typename L::Params& p, const BlockVector<L::dim>& delta, Mode& mode,
             const BlockVector<L::dim>& lambda) {
  { L::event(p, delta, mode, lambda) } -> std::same_as<bool>;
};

/// A law whose blocks do not all begin the next step in the mode in which they ended this one adds
///   static Mode next_mode(const Params&, const BlockVector<dim>& delta, Mode,
///                         const BlockVector<dim>& lambda)
/// Called once per step, with what its end is.
template <class L>
concept LawWithNextMode = Law<L> &&
    requires(const typename L::Params& p, const BlockVector<L::dim>& delta, Mode mode,
             const BlockVector<L::dim>& lambda) {
  { L::next_mode(p, delta, mode, lambda) } -> std::same_as<Mode>;
};

/// One block, untyped, as the solver stores it. Pointers into the problem's arrays.
struct BlockView {
  const Real* W;  ///< dim x dim, column major
  const Real* d;  ///< dim; for free_directions: delta
  const void* params;
  Mode* mode;
  Real* lambda;  ///< dim
};

struct FreeDirectionsView {
  int count = 0;
  Real move[max_block_dim * max_block_dim];  ///< dim x count, column major
  Real test[max_block_dim * max_block_dim];
  Real gap[max_block_dim];
  Real compliance[max_block_dim * max_block_dim];  ///< as move; its first count rows
};

/// The functions of a law behind plain pointers: one indirect call per block or per run.
struct LawOperations {
  const char* name;
  int dim;
  std::size_t params_size;
  void (*project)(const BlockView&);
  void (*free_directions)(const BlockView&, FreeDirectionsView&);
  bool (*event)(const void* params, const Real* delta, Mode* mode,
                const Real* lambda);  ///< or null
  Mode (*next_mode)(const void* params, const Real* delta, Mode mode,
                    const Real* lambda);  ///< or null: the mode stays
};

namespace detail {

template <class L>
void project_block(const BlockView& b) {
  constexpr int n = L::dim;
  const BlockMatrix<n> W = Eigen::Map<const BlockMatrix<n>>(b.W);
  const BlockVector<n> d = Eigen::Map<const BlockVector<n>>(b.d);
  Eigen::Map<BlockVector<n>> out(b.lambda);
  BlockVector<n> lambda = out;
  L::project(W, d, *static_cast<const typename L::Params*>(b.params), *b.mode, lambda);
  out = lambda;
}

template <class L>
void free_directions_of_block(const BlockView& b, FreeDirectionsView& out) {
  constexpr int n = L::dim;
  const BlockVector<n> delta = Eigen::Map<const BlockVector<n>>(b.d);
  const BlockVector<n> lambda = Eigen::Map<const BlockVector<n>>(b.lambda);
  FreeDirections<n> free;
  L::free_directions(delta, *static_cast<const typename L::Params*>(b.params), *b.mode, lambda,
                     free);
  out.count = free.count;
  Eigen::Map<BlockMatrix<n>>(out.move) = free.move;
  Eigen::Map<BlockMatrix<n>>(out.test) = free.test;
  Eigen::Map<BlockVector<n>>(out.gap) = free.gap;
  Eigen::Map<BlockMatrix<n>>(out.compliance) = free.compliance;
}

template <class L>
bool event_of_block(const void* params, const Real* delta, Mode* mode, const Real* lambda) {
  constexpr int n = L::dim;
  return L::event(*static_cast<const typename L::Params*>(params),
                  BlockVector<n>(Eigen::Map<const BlockVector<n>>(delta)), *mode,
                  BlockVector<n>(Eigen::Map<const BlockVector<n>>(lambda)));
}

template <class L>
Mode next_mode_of_block(const void* params, const Real* delta, Mode mode, const Real* lambda) {
  constexpr int n = L::dim;
  return L::next_mode(*static_cast<const typename L::Params*>(params),
                      BlockVector<n>(Eigen::Map<const BlockVector<n>>(delta)), mode,
                      BlockVector<n>(Eigen::Map<const BlockVector<n>>(lambda)));
}

template <class L>
constexpr LawOperations make_operations() {
  LawOperations ops{
      L::name, L::dim, sizeof(typename L::Params), &project_block<L>, &free_directions_of_block<L>,
      nullptr, nullptr};
  if constexpr (LawWithEvents<L>) ops.event = &event_of_block<L>;
  if constexpr (LawWithNextMode<L>) ops.next_mode = &next_mode_of_block<L>;
  return ops;
}

}  // namespace detail

template <Law L>
inline constexpr LawOperations law_operations = detail::make_operations<L>();

}  // namespace sutura
