#include "panels.h"

#include <algorithm>
#include <cassert>

namespace sutura::opencl {
namespace {

/// Columns to panels, ascending; where each column's panel is.
void cut(const SupernodalFactor& factor, Schedule& s, std::vector<std::int32_t>& panel_of) {
  std::int32_t front = 0;
  panel_of.resize(static_cast<std::size_t>(factor.size));
  for (std::size_t n = 0; n + 1 < factor.first_column.size(); ++n) {
    const std::int32_t first = factor.first_column[n], columns = factor.first_column[n + 1] - first;
    const std::int32_t rows = factor.first_row[n + 1] - factor.first_row[n];
    const std::int32_t parts = (columns + most_width - 1) / most_width;
    for (std::int32_t part = 0; part < parts; ++part) {
      const std::int32_t begin = columns * part / parts, end = columns * (part + 1) / parts;
      Panel p{};
      p.first = first + begin;
      p.width = end - begin;
      p.height = rows - begin;
      p.stride = rows;
      p.value = factor.first_value[n] + begin * rows + begin;
      p.row = factor.first_row[n] + begin;
      p.below = static_cast<std::int32_t>(s.below_size);
      p.front = front;
      p.z = static_cast<std::int32_t>(s.z_size);
      s.below_size += p.height - p.width;
      s.z_size += std::int64_t{p.width} * p.height;
      front += p.height;
      for (std::int32_t c = p.first; c < p.first + p.width; ++c)
        panel_of[static_cast<std::size_t>(c)] = static_cast<std::int32_t>(s.panels.size());
      s.panels.push_back(p);
    }
  }
}

/// Where in the front of its parent each row below a panel is.
void find_gathers(const SupernodalFactor& factor, const std::vector<std::int32_t>& parent,
                  Schedule& s) {
  const Panel& last = s.panels.back();
  const auto fronts = static_cast<std::size_t>(last.front + last.height);
  std::vector<std::int32_t> to(static_cast<std::size_t>(s.below_size));
  std::vector<std::int32_t> start(fronts + 1, 0);
  for (std::size_t n = 0; n < s.panels.size(); ++n) {
    if (parent[n] < 0) continue;
    const Panel& p = s.panels[n];
    const Panel& above = s.panels[static_cast<std::size_t>(parent[n])];
    const auto row = [&](const Panel& of, std::int32_t k) {
      return factor.row[static_cast<std::size_t>(of.row + k)];
    };
    std::int32_t at = 0;
    for (std::int32_t k = p.width; k < p.height; ++k) {
      while (row(above, at) != row(p, k)) ++at;  // rows of a child are rows of its parent
      assert(at < above.height);
      to[static_cast<std::size_t>(p.below + k - p.width)] = above.front + at;
      ++start[static_cast<std::size_t>(above.front + at) + 1];
    }
  }
  // Entries without a front are those of roots: none.
  for (std::size_t i = 0; i < fronts; ++i) start[i + 1] += start[i];
  std::vector<std::int32_t> list(static_cast<std::size_t>(start[fronts])), next = start;
  for (std::size_t i = 0; i < to.size(); ++i)
    list[static_cast<std::size_t>(next[static_cast<std::size_t>(to[i])]++)] =
        static_cast<std::int32_t>(i);
  const auto nothing = static_cast<std::int32_t>(s.below_size);
  for (std::size_t r = 0; r < fronts; ++r) {
    std::array<std::int32_t, 4> four;
    four.fill(nothing);
    const auto begin = list.begin() + start[r], end = list.begin() + start[r + 1];
    const auto some = std::min<std::ptrdiff_t>(end - begin, end - begin > 4 ? 3 : 4);
    std::copy(begin, begin + some, four.begin());
    if (begin + some < end) {
      four[3] = -2 - static_cast<std::int32_t>(s.gather_more.size());
      s.gather_more.insert(s.gather_more.end(), begin + some, end);
      s.gather_more.push_back(-1);
    }
    s.gather.push_back(four);
  }
  s.gather_more.push_back(-1);
}

std::int32_t size(const std::vector<Task>& tasks) {
  return static_cast<std::int32_t>(tasks.size());
}

std::int32_t tiles(std::int32_t length, std::int32_t tile) {
  return (length + tile - 1) / tile;
}

void add_tasks(std::vector<Task>& tasks, std::int32_t panel, std::int32_t count) {
  for (std::int32_t t = 0; t < count; ++t) tasks.push_back({panel, t});
}

}  // namespace

Schedule make_schedule(const SupernodalFactor& factor, std::span<const std::int64_t> tiers) {
  Schedule s;
  std::vector<std::int32_t> panel_of;
  cut(factor, s, panel_of);
  const std::size_t count = s.panels.size();
  std::vector<std::int32_t> parent(count, -1);
  std::vector<std::int64_t> values(count, 0);  // of the subtree
  for (std::size_t n = 0; n < count; ++n) {
    const Panel& p = s.panels[n];
    values[n] += std::int64_t{p.width} * p.height;
    const std::int32_t w = tiles(p.width, large_tile);
    add_tasks(s.triangles, static_cast<std::int32_t>(n), w);
    add_tasks(s.below, static_cast<std::int32_t>(n), w * tiles(p.height - p.width, large_tile));
    if (p.height == p.width) continue;
    parent[n] =
        panel_of[static_cast<std::size_t>(factor.row[static_cast<std::size_t>(p.row + p.width)])];
    values[static_cast<std::size_t>(parent[n])] += values[n];
  }
  if (count > 0) find_gathers(factor, parent, s);

  // The tier of a panel is the first for which its subtree is small enough; panels of one tier that
  // hang together are one subtree.
  const std::size_t levels_tier = tiers.size();
  std::vector<std::size_t> tier(count, 0);
  std::vector<std::int32_t> root(count, -1), level(count, 0);
  std::vector<std::vector<std::int32_t>> members(count), levels;
  for (std::size_t n = count; n-- > 0;) {
    while (tier[n] < levels_tier && values[n] > tiers[tier[n]]) ++tier[n];
    const bool inside = parent[n] >= 0 && tier[static_cast<std::size_t>(parent[n])] == tier[n];
    root[n] = inside ? root[static_cast<std::size_t>(parent[n])] : static_cast<std::int32_t>(n);
  }
  for (std::size_t n = 0; n < count; ++n) {
    if (tier[n] < levels_tier) {
      members[static_cast<std::size_t>(root[n])].push_back(static_cast<std::int32_t>(n));
      continue;
    }
    const auto mine = static_cast<std::size_t>(level[n]);
    if (levels.size() <= mine) levels.resize(mine + 1);
    levels[mine].push_back(static_cast<std::int32_t>(n));
    if (parent[n] >= 0) {
      auto& above = level[static_cast<std::size_t>(parent[n])];
      above = std::max(above, level[n] + 1);
    }
  }
  s.subtree_start.push_back(0);
  for (std::size_t t = 0; t < levels_tier; ++t) {
    Schedule::Range range{static_cast<std::int32_t>(s.subtree_start.size()) - 1, 0};
    for (std::size_t n = 0; n < count; ++n) {
      if (members[n].empty() || tier[n] != t) continue;
      s.subtree.insert(s.subtree.end(), members[n].begin(), members[n].end());
      s.subtree_start.push_back(static_cast<std::int32_t>(s.subtree.size()));
      ++range.count;
    }
    if (range.count > 0) s.tiers.push_back(range);
  }
  const auto add = [](std::vector<Task>& tasks, const std::vector<std::int32_t>& panels,
                      const auto& count_of) {
    Schedule::Range range{size(tasks), 0};
    for (const std::int32_t n : panels) add_tasks(tasks, n, count_of(n));
    range.count = size(tasks) - range.first;
    return range;
  };
  for (const auto& panels : levels) {
    const auto panel = [&](std::int32_t n) { return s.panels[static_cast<std::size_t>(n)]; };
    Schedule::Level l{};
    l.rows = add(s.rows, panels, [&](auto n) { return tiles(panel(n).height, tile_rows); });
    l.columns = add(s.columns, panels, [&](auto n) { return tiles(panel(n).width, tile_columns); });
    s.levels.push_back(l);
  }
  return s;
}

}  // namespace sutura::opencl
