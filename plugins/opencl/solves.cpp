// Solving with a supernodal factor: upload, schedule, launches.
#include <algorithm>
#include <array>

#include "gradients.h"
#include "solves_program.h"

namespace sutura::opencl {
namespace {

constexpr std::size_t items = 256;
/// Subtrees of the tiers: shares of the factor, and the least number of entries. So that all units
/// have some, and that a group does not go through many panels.
constexpr std::array<std::int64_t, 3> shares{9600, 2400, 600};
constexpr std::array<std::int64_t, 3> least{1500, 6000, 20000};

}  // namespace

cl_program build_solves(const Device& device, Precision precision, bool rough, const char* more) {
  return device.build(definitions(precision) + "typedef " + (rough ? "float" : "double") +
                          " number;\n" + programs::solves + more,
                      "-DITEMS=256 -DMOST_WIDTH=" + std::to_string(most_width));
}

Solves::Program::Program(const Device& device, Precision precision, bool rough)
    : rough(rough),
      program(build_solves(device, precision, rough, "")),
      invert_tiles(device, program, "invert_tiles"),
      invert_columns(device, program, "invert_columns"),
      multiply_below(device, program, "multiply_below"),
      forward(device, program, "solve_forward"),
      back(device, program, "solve_back"),
      subtrees(device, program, "solve_subtrees"),
      back_subtrees(device, program, "solve_back_subtrees") {}

Solves::Program::~Program() {
  clReleaseProgram(program);
}

Solves::Solves(const Device& device, Precision precision)
    : device_(device),
      precision_(precision),
      panels_(device),
      gather_(device),
      gather_more_(device),
      rows_(device),
      subtree_start_(device),
      subtree_(device),
      row_tasks_(device),
      column_tasks_(device),
      large_row_tasks_(device),
      large_column_tasks_(device),
      triangle_tasks_(device),
      multiply_tasks_(device),
      value_(device),
      z_(device),
      below_(device),
      y_(device) {}

Solves::~Solves() = default;

bool Solves::same_pattern(const SupernodalFactor& f) const {
  return size_ == f.size && std::ranges::equal(first_column_, f.first_column) &&
         std::ranges::equal(row_, f.row) && std::ranges::equal(row_of_, f.row_of);
}

void Solves::set_factor(const SupernodalFactor& factor) {
  const bool rough = !factor.rough.empty() || !has_double_sums(precision_);
  if (!program_ || program_->rough != rough)
    program_ = std::make_unique<Program>(device_, precision_, rough);
  if (!same_pattern(factor)) {
    size_ = factor.size;
    first_column_.assign(factor.first_column.begin(), factor.first_column.end());
    row_.assign(factor.row.begin(), factor.row.end());
    row_of_ = factor.row_of;
    const auto values = static_cast<std::int64_t>(factor.value.size());
    std::array<std::int64_t, shares.size()> tiers{};
    for (std::size_t t = 0; t < tiers.size(); ++t) tiers[t] = std::max(least[t], values / shares[t]);
    schedule_ = make_schedule(factor, tiers);
    panels_.write(schedule_.panels);
    gather_.write(schedule_.gather);
    gather_more_.write(schedule_.gather_more);
    rows_.write(row_);
    subtree_start_.write(schedule_.subtree_start);
    subtree_.write(schedule_.subtree);
    row_tasks_.write(schedule_.rows);
    column_tasks_.write(schedule_.columns);
    large_row_tasks_.write(schedule_.large_rows);
    large_column_tasks_.write(schedule_.large_columns);
    triangle_tasks_.write(schedule_.triangles);
    multiply_tasks_.write(schedule_.below);
  }
  const std::size_t number = rough ? 4 : 8, real = has_double_sums(precision_) ? 8 : 4;
  std::vector<float> rounded;
  if (!rough) {
    value_.write(factor.value.data(), factor.value.size_bytes());
  } else if (!factor.rough.empty()) {
    value_.write(factor.rough.data(), factor.rough.size_bytes());
  } else {
    rounded.assign(factor.value.begin(), factor.value.end());
    value_.write(rounded);
  }
  z_.reserve(static_cast<std::size_t>(schedule_.z_size) * number);
  below_.reserve((static_cast<std::size_t>(schedule_.below_size) + 2) * real);
  const double nothing = 0;
  below_.write_at(static_cast<std::size_t>(schedule_.below_size) * real, &nothing, real);
  y_.reserve(static_cast<std::size_t>(size_) * real);
  Program& p = *program_;
  p.invert_tiles(schedule_.triangles.size() * items, items, triangle_tasks_, panels_, value_, z_);
  p.invert_columns(schedule_.triangles.size() * items, items, triangle_tasks_, panels_, value_, z_);
  p.multiply_below(schedule_.below.size() * items, items, multiply_tasks_, panels_, value_, z_);
  device_.finish();  // the factor may change from now on
}

void Solves::forward_small(const Buffer& b, const Buffer& done) {
  for (const Schedule::Range& t : schedule_.tiers)
    program_->subtrees(static_cast<std::size_t>(t.count) * items, items, t.first, subtree_start_,
                       subtree_, panels_, gather_, gather_more_, z_, b, below_, y_, done);
}

void Solves::finish(const Buffer& b, const Buffer& x, const Buffer& done) {
  Program& p = *program_;
  const auto groups = [](const Schedule::Range& r) {
    return static_cast<std::size_t>(r.count) * items;
  };
  for (const Schedule::Level& l : schedule_.levels)
    p.forward(groups(l.rows), items, l.rows.first, row_tasks_, panels_, gather_, gather_more_, z_,
              b, below_, y_, done);
  for (std::size_t n = schedule_.levels.size(); n-- > 0;) {
    const Schedule::Level& l = schedule_.levels[n];
    p.back(groups(l.columns), items, l.columns.first, column_tasks_, panels_, rows_, z_, y_, x,
           done);
  }
  for (std::size_t n = schedule_.tiers.size(); n-- > 0;) {
    const Schedule::Range& t = schedule_.tiers[n];
    p.back_subtrees(groups(t), items, t.first, subtree_start_, subtree_, panels_, rows_, z_, y_, x,
                    done);
  }
}

}  // namespace sutura::opencl
