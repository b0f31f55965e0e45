// Many right-hand sides of a supernodal factor at once: for the compliance of touched nodes.
#include <algorithm>
#include <cassert>

#include "gradients.h"
#include "solves_program.h"

namespace sutura::opencl {
namespace {

constexpr std::size_t items = 256;

}  // namespace

Solves::Many::Many(const Device& device, Precision precision, bool rough)
    : rough(rough),
      program(build_solves(device, precision, rough, programs::many_solves)),
      rows(device, program, "solve_many_rows"),
      back(device, program, "solve_many_back"),
      subtrees(device, program, "solve_many_subtrees"),
      back_subtrees(device, program, "solve_many_back_subtrees"),
      units(device, program, "many_units"),
      pick(device, program, "many_entries"),
      b(device),
      left(device),
      y(device),
      x(device),
      positions(device),
      rows_wanted(device),
      picked(device) {}

Solves::Many::~Many() {
  clReleaseProgram(program);
}

void Solves::entries_of_inverse(const std::vector<std::int32_t>& rows,
                                const std::vector<std::int32_t>& of_columns,
                                Eigen::Ref<MatX> entries) {
  assert(of_columns.size() <= columns && entries.rows() == static_cast<Index>(rows.size()));
  if (!many_ || many_->rough != program_->rough)
    many_ = std::make_unique<Many>(device_, precision_, program_->rough);
  Many& m = *many_;
  const std::size_t real = has_double_sums(precision_) ? 8 : 4, width = real * columns;
  for (Buffer* buffer : {&m.b, &m.y, &m.x})
    buffer->reserve(static_cast<std::size_t>(size_) * width);
  m.left.reserve((static_cast<std::size_t>(schedule_.below_size) + 2) * width);
  const std::vector<double> nothing(columns, 0.0);
  m.left.write_at(static_cast<std::size_t>(schedule_.below_size) * width, nothing.data(), width);
  m.wanted = of_columns;
  m.wanted.resize(columns, -1);
  m.positions.write(m.wanted);
  m.units(static_cast<std::size_t>(size_) * columns, items, static_cast<cl_int>(size_), m.positions,
          m.b);

  const auto groups = [](const Schedule::Range& r) {
    return static_cast<std::size_t>(r.count) * items;
  };
  for (const Schedule::Range& t : schedule_.tiers)
    m.subtrees(groups(t), items, t.first, subtree_start_, subtree_, panels_, gather_, gather_more_,
               z_, m.b, m.left, m.y);
  for (const Schedule::Level& l : schedule_.levels)
    m.rows(groups(l.large_rows), items, l.large_rows.first, large_row_tasks_, panels_,
           gather_, gather_more_, z_, m.b, m.left, m.y);
  for (std::size_t n = schedule_.levels.size(); n-- > 0;) {
    const Schedule::Range& l = schedule_.levels[n].large_columns;
    m.back(groups(l), items, l.first, large_column_tasks_, panels_, rows_, z_, m.y, m.x);
  }
  for (std::size_t n = schedule_.tiers.size(); n-- > 0;) {
    const Schedule::Range& t = schedule_.tiers[n];
    m.back_subtrees(groups(t), items, t.first, subtree_start_, subtree_, panels_, rows_, z_, m.y,
                    m.x);
  }

  const std::size_t count = rows.size() * of_columns.size();
  m.picked.reserve(rows.size() * width);
  m.rows_wanted.write(rows);
  m.pick(rows.size() * columns, items, static_cast<cl_int>(rows.size()), m.rows_wanted, m.x,
         m.picked);
  const auto take = [&](auto& numbers) {
    numbers.resize(count);
    m.picked.read(numbers);
    for (Index c = 0; c < entries.cols(); ++c)
      for (Index r = 0; r < entries.rows(); ++r)
        entries(r, c) = numbers[static_cast<std::size_t>(c * entries.rows() + r)];
  };
  if (has_double_sums(precision_))
    take(m.doubles);
  else
    take(m.floats);
}

}  // namespace sutura::opencl
