// Solving with a supernodal factor: upload, schedule, launches.
#include <algorithm>

#include "gradients.h"
#include "solves_program.h"

namespace sutura::opencl {
namespace {

constexpr std::size_t items = 256;
constexpr std::int64_t least_subtree = 20000, subtrees = 600;  // so that all units have some

}  // namespace

cl_program build_solves(const Device& device, Precision precision, bool rough, const char* more) {
  return device.build(definitions(precision) + "typedef " + (rough ? "float" : "double") +
                          " number;\n" + programs::solves + more,
                      "-DITEMS=256 -DMOST_WIDTH=" + std::to_string(most_width));
}

Solves::Program::Program(const Device& device, Precision precision, bool rough)
    : rough(rough),
      program(build_solves(device, precision, rough, "")),
      invert(device, program, "invert"),
      rows(device, program, "solve_rows"),
      below(device, program, "solve_below"),
      back_below(device, program, "solve_back_below"),
      back_columns(device, program, "solve_back_columns"),
      subtrees(device, program, "solve_subtrees"),
      back_subtrees(device, program, "solve_back_subtrees") {}

Solves::Program::~Program() {
  clReleaseProgram(program);
}

Solves::Solves(const Device& device, Precision precision)
    : device_(device),
      precision_(precision),
      panels_(device),
      gather_start_(device),
      gather_(device),
      rows_(device),
      subtree_start_(device),
      subtree_(device),
      row_tasks_(device),
      below_tasks_(device),
      column_tasks_(device),
      value_(device),
      inverse_(device),
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
    schedule_ = make_schedule(factor, std::max(least_subtree, values / subtrees));
    panels_.write(schedule_.panels);
    gather_start_.write(schedule_.gather_start);
    gather_.write(schedule_.gather);
    rows_.write(row_);
    subtree_start_.write(schedule_.subtree_start);
    subtree_.write(schedule_.subtree);
    row_tasks_.write(schedule_.row_tasks);
    below_tasks_.write(schedule_.below_tasks);
    column_tasks_.write(schedule_.column_tasks);
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
  inverse_.reserve(static_cast<std::size_t>(schedule_.inverse_size) * number);
  below_.reserve((static_cast<std::size_t>(schedule_.below_size) + 2) * real);
  y_.reserve(static_cast<std::size_t>(size_) * real);
  if (!schedule_.panels.empty())
    program_->invert(schedule_.panels.size() * items, items, panels_, value_, inverse_);
  device_.finish();  // the factor may change from now on
}

void Solves::solve(const Buffer& b, const Buffer& x, const Buffer& done) {
  Program& p = *program_;
  const std::size_t trees = schedule_.subtree_start.size() - 1;
  const auto groups = [](std::int32_t tasks) { return static_cast<std::size_t>(tasks) * items; };
  if (trees > 0)
    p.subtrees(trees * items, items, subtree_start_, subtree_, panels_, gather_start_, gather_,
               value_, inverse_, b, below_, y_, done);
  for (const Schedule::Level& l : schedule_.levels) {
    p.rows(groups(l.rows), items, l.first_rows, row_tasks_, panels_, gather_start_, gather_,
           inverse_, b, below_, y_, done);
    p.below(groups(l.below), items, l.first_below, below_tasks_, panels_, gather_start_, gather_,
            value_, b, below_, y_, done);
  }
  for (std::size_t n = schedule_.levels.size(); n-- > 0;) {
    const Schedule::Level& l = schedule_.levels[n];
    p.back_below(groups(l.columns), items, l.first_columns, column_tasks_, panels_, rows_, value_,
                 y_, x, done);
    p.back_columns(groups(l.columns), items, l.first_columns, column_tasks_, panels_, inverse_, y_,
                   x, done);
  }
  if (trees > 0)
    p.back_subtrees(trees * items, items, subtree_start_, subtree_, panels_, rows_, value_,
                    inverse_, y_, x, done);
}

}  // namespace sutura::opencl
