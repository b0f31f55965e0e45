// Solving with a supernodal factor: upload, schedule, launches.
#include <algorithm>
#include <array>
#include <cassert>

#include "gradients.h"
#include "programs.h"

namespace sutura::opencl {
namespace {

constexpr std::size_t items = 256;
/// Subtrees of the tiers: shares of the factor, and the least number of entries. So that all units
/// have some, and that a group does not go through many panels.
constexpr std::array<std::int64_t, 3> shares{9600, 2400, 600};
constexpr std::array<std::int64_t, 3> least{1500, 6000, 20000};

/// Numbers of a front that fit into local memory.
constexpr int front = 2560;

}  // namespace

bool Solves::same_pattern(const SupernodalFactor& f) const {
  return size_ == f.size && std::ranges::equal(first_column_, f.first_column) &&
         std::ranges::equal(row_, f.row) && std::ranges::equal(row_of_, f.row_of);
}

void Solves::set_factor(const SupernodalFactor& factor) {
  const bool rough = !factor.rough.empty() || !has_double_sums(precision_);
  if (!program_ || rough_ != rough) {
    rough_ = rough;
    program_.emplace(
        device_, precision_,
        std::string("typedef ") + (rough ? "float" : "double") + " number;\n" + programs::solves,
        "-DITEMS=256 -DMOST_WIDTH=" + std::to_string(most_width) +
            " -DFRONT=" + std::to_string(front));
  }
  if (!same_pattern(factor)) {
    size_ = factor.size;
    first_column_.assign(factor.first_column.begin(), factor.first_column.end());
    row_.assign(factor.row.begin(), factor.row.end());
    row_of_ = factor.row_of;
    const auto values = static_cast<std::int64_t>(factor.value.size());
    std::array<std::int64_t, shares.size()> tiers{};
    for (std::size_t t = 0; t < tiers.size(); ++t)
      tiers[t] = std::max(least[t], values / shares[t]);
    schedule_ = make_schedule(factor, tiers);
    panels_.write(schedule_.panels);
    gather_.write(schedule_.gather);
    gather_more_.write(schedule_.gather_more);
    rows_.write(row_);
    subtree_start_.write(schedule_.subtree_start);
    subtree_.write(schedule_.subtree);
    row_tasks_.write(schedule_.rows);
    column_tasks_.write(schedule_.columns);
    triangle_tasks_.write(schedule_.triangles);
    multiply_tasks_.write(schedule_.below);
  }
  std::vector<float> rounded;
  if (!rough) {
    value_.write(factor.value.data(), factor.value.size_bytes());
  } else if (!factor.rough.empty()) {
    value_.write(factor.rough.data(), factor.rough.size_bytes());
  } else {
    rounded.assign(factor.value.begin(), factor.value.end());
    value_.write(rounded);
  }
  z_.reserve(static_cast<std::size_t>(schedule_.z_size) * (rough ? 4 : 8));
  below_.reserve(static_cast<std::size_t>(left()));
  const Real nothing = 0;
  below_.write_at(static_cast<std::size_t>(schedule_.below_size), {&nothing, 1});
  y_.reserve(static_cast<std::size_t>(size_));
  const cl_int no[4] = {};
  not_done_.write(no, sizeof(no));
  Program& p = *program_;
  p["invert_tiles"](schedule_.triangles.size() * items, items, triangle_tasks_, panels_, value_,
                    z_);
  p["invert_columns"](schedule_.triangles.size() * items, items, triangle_tasks_, panels_, value_,
                      z_);
  p["multiply_below"](schedule_.below.size() * items, items, multiply_tasks_, panels_, value_, z_);
  device_.finish();  // the factor may change from now on
}

void Solves::forward_small(const Sides& s) {
  for (const Schedule::Range& t : schedule_.tiers)
    (*program_)["solve_subtrees"](groups(t, s), items, t.first, t.count, size(), left(),
                                  subtree_start_, subtree_, panels_, gather_, gather_more_, z_, s.b,
                                  s.below, s.y, s.done);
}

void Solves::finish(const Sides& s) {
  Program& p = *program_;
  for (const Schedule::Level& l : schedule_.levels)
    p["solve_forward"](groups(l.rows, s), items, l.rows.first, l.rows.count, size(), left(),
                       row_tasks_, panels_, gather_, gather_more_, z_, s.b, s.below, s.y, s.done);
  for (std::size_t n = schedule_.levels.size(); n-- > 0;) {
    const Schedule::Range& l = schedule_.levels[n].columns;
    p["solve_back"](groups(l, s), items, l.first, l.count, size(), column_tasks_, panels_, rows_,
                    z_, s.y, s.x, s.done);
  }
  for (std::size_t n = schedule_.tiers.size(); n-- > 0;) {
    const Schedule::Range& t = schedule_.tiers[n];
    p["solve_back_subtrees"](groups(t, s), items, t.first, t.count, size(), subtree_start_,
                             subtree_, panels_, rows_, z_, s.y, s.x, s.done);
  }
}

void Solves::entries_of_inverse(const std::vector<std::int32_t>& rows,
                                const std::vector<std::int32_t>& columns,
                                Eigen::Ref<MatX> entries) {
  assert(columns.size() <= most_columns && entries.rows() == static_cast<Index>(rows.size()));
  const std::size_t count = columns.size(), all = static_cast<std::size_t>(size_) * count,
                    picked = rows.size() * count;
  for (Numbers* v : {&many_b_, &many_y_, &many_x_}) v->reserve(all);
  many_below_.reserve(static_cast<std::size_t>(left()) * count);
  positions_.write(columns);
  rows_wanted_.write(rows);
  const auto sides = static_cast<cl_int>(count);
  (*program_)["many_units"](all, items, size(), sides, left(),
                            static_cast<cl_int>(schedule_.below_size), positions_, many_b_,
                            many_below_);
  const Sides s{many_b_, many_below_, many_y_, many_x_, not_done_, sides};
  forward_small(s);
  finish(s);
  picked_.reserve(picked);
  (*program_)["many_entries"](picked, items, static_cast<cl_int>(rows.size()), sides, size(),
                              rows_wanted_, many_x_, picked_);
  host_picked_.resize(picked);
  picked_.read(host_picked_);
  entries = Eigen::Map<const MatX>(host_picked_.data(), entries.rows(), entries.cols());
}

}  // namespace sutura::opencl
