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
      p.inverse = static_cast<std::int32_t>(s.inverse_size);
      s.below_size += p.height - p.width;
      s.inverse_size += std::int64_t{p.width} * p.width;
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
  s.gather_start.assign(fronts + 1, 0);
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
      ++s.gather_start[static_cast<std::size_t>(above.front + at) + 1];
    }
  }
  for (std::size_t i = 0; i < fronts; ++i) s.gather_start[i + 1] += s.gather_start[i];
  s.gather.resize(to.size());
  std::vector<std::int32_t> next = s.gather_start;
  for (std::size_t i = 0; i < to.size(); ++i)
    s.gather[static_cast<std::size_t>(next[static_cast<std::size_t>(to[i])]++)] =
        static_cast<std::int32_t>(i);
}

void add_tasks(std::vector<Task>& tasks, std::int32_t panel, std::int32_t size, int tile) {
  for (std::int32_t t = 0; t * tile < size; ++t) tasks.push_back({panel, t});
}

}  // namespace

Schedule make_schedule(const SupernodalFactor& factor, std::int64_t subtree_values) {
  Schedule s;
  std::vector<std::int32_t> panel_of;
  cut(factor, s, panel_of);
  const std::size_t count = s.panels.size();
  std::vector<std::int32_t> parent(count, -1);
  std::vector<std::int64_t> values(count, 0);  // of the subtree
  for (std::size_t n = 0; n < count; ++n) {
    const Panel& p = s.panels[n];
    values[n] += std::int64_t{p.width} * p.height;
    if (p.height == p.width) continue;
    parent[n] =
        panel_of[static_cast<std::size_t>(factor.row[static_cast<std::size_t>(p.row + p.width)])];
    values[static_cast<std::size_t>(parent[n])] += values[n];
  }
  if (count > 0) find_gathers(factor, parent, s);

  // A subtree is one if it is small and that of its parent is not.
  std::vector<std::int32_t> root(count, -1), level(count, 0);
  std::vector<std::vector<std::int32_t>> members(count), levels;
  for (std::size_t n = count; n-- > 0;) {
    if (values[n] > subtree_values) continue;
    const bool inside = parent[n] >= 0 && root[static_cast<std::size_t>(parent[n])] >= 0;
    root[n] = inside ? root[static_cast<std::size_t>(parent[n])] : static_cast<std::int32_t>(n);
  }
  for (std::size_t n = 0; n < count; ++n) {
    if (root[n] >= 0) {
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
  for (const auto& m : members) {
    if (m.empty()) continue;
    s.subtree.insert(s.subtree.end(), m.begin(), m.end());
    s.subtree_start.push_back(static_cast<std::int32_t>(s.subtree.size()));
  }
  const auto size = [](const std::vector<Task>& t) { return static_cast<std::int32_t>(t.size()); };
  for (const auto& panels : levels) {
    Schedule::Level l{};
    l.first_rows = size(s.row_tasks);
    l.first_below = size(s.below_tasks);
    l.first_columns = size(s.column_tasks);
    for (const std::int32_t n : panels) {
      const Panel& p = s.panels[static_cast<std::size_t>(n)];
      add_tasks(s.row_tasks, n, p.width, tile_rows);
      add_tasks(s.below_tasks, n, p.height - p.width, tile_rows);
      add_tasks(s.column_tasks, n, p.width, tile_columns);
    }
    l.rows = size(s.row_tasks) - l.first_rows;
    l.below = size(s.below_tasks) - l.first_below;
    l.columns = size(s.column_tasks) - l.first_columns;
    s.levels.push_back(l);
  }
  return s;
}

}  // namespace sutura::opencl
