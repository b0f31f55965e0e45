// A supernodal factor cut into panels, and who works on which of them when.
//
// A panel is some columns of a supernode, at most `most_width`. Its front is its column rows and
// the rows below. Solving forward, a panel gathers from the panels whose rows below end in its
// front (its children) what they leave, solves its columns and leaves the rest to its own parent:
// nothing is added by two at once, so the sums have one order. Small subtrees are the work of one
// group each: first the smallest, then what is left of larger ones, tier by tier; above them all
// panels whose children are done are worked on together, level by level.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sutura/device.h"

namespace sutura::opencl {

/// As `Panel` in solves.cl.
struct Panel {
  std::int32_t first, width, height;  ///< columns; rows of the front
  std::int32_t stride, value;         ///< of its numbers in the factor
  std::int32_t row;                   ///< its rows in the list of all
  std::int32_t below;                 ///< what it leaves, in the list of all
  std::int32_t front;                 ///< its front, in the list of all
  std::int32_t z;                     ///< its numbers as solves.cl has them, height x width
};

/// A group's work: a panel and which part of it.
using Task = std::array<std::int32_t, 2>;

struct Schedule {
  std::vector<Panel> panels;
  /// Per row of a front: which entries of `below` it gathers. Where there are more than four, the
  /// last is -2 - k: from gather_more[k] on, ended by -1. Entry below_size is always zero.
  std::vector<std::array<std::int32_t, 4>> gather;
  std::vector<std::int32_t> gather_more;
  std::vector<std::int32_t> subtree_start, subtree;  ///< panels of each, children first
  struct Range {
    std::int32_t first, count;
  };
  std::vector<Range> tiers;  ///< of subtrees; each after those before it
  struct Level {
    Range rows, columns;  ///< tasks of the way forward and back
  };
  std::vector<Level> levels;
  std::vector<Task> rows, columns;
  std::vector<Task> triangles, below;  ///< of setting up: tiles on the diagonal, tiles below
  std::int64_t below_size = 0, z_size = 0;
};

inline constexpr int most_width = 1280;
inline constexpr int tile_rows = 16, tile_columns = 8;  ///< of a task of a level
inline constexpr int large_tile = 64;                   ///< rows or columns of a task of setting up

/// `tiers`: up to how many entries of the factor a subtree of each tier has, ascending.
Schedule make_schedule(const SupernodalFactor& factor, std::span<const std::int64_t> tiers);

}  // namespace sutura::opencl
