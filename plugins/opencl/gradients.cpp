#include "gradients.h"

#include <algorithm>
#include <cassert>
#include <new>
#include <string>

#include "programs.h"

namespace sutura::opencl {
namespace {

constexpr std::size_t items = 256, groups = 128;  // of sums over all nodes

/// Of kept solutions with b and with each other's products.
constexpr int sums_of(int kept) {
  return kept + kept * (kept + 1) / 2;
}
constexpr std::size_t most_sums = sums_of(ConjugateGradientDevice::most_recent);
static_assert(8 * most_sums <= items);  // as kept_weights has them

}  // namespace

Gradients::Gradients(const Device& device, Precision precision)
    : device_(device),
      real_(size_of_sum(precision)),
      entry_(size_of_entry(precision)),
      solves_(device, precision),
      elements_(device, precision),
      contacts_(device, precision),
      program_(device, precision, programs::gradients,
               "-DITEMS=256 -DGROUPS=128 -DMOST=" + std::to_string(most_kept)),
      statuses_(device, 2 * sizeof(GradientStatus)) {}

Gradients::~Gradients() {
  device_.drain();
}

void Gradients::set_pattern(const NodeMatrixView& A, std::span<const char> fixed) {
  if (A.nodes == nodes_ && std::ranges::equal(A.row_start, row_start_) &&
      std::ranges::equal(A.column, column_) &&
      std::equal(fixed.begin(), fixed.end(), fixed_.begin()))
    return;
  nodes_ = static_cast<int>(A.nodes);
  row_start_.assign(A.row_start.begin(), A.row_start.end());
  column_.assign(A.column.begin(), A.column.end());
  fixed_.assign(fixed.begin(), fixed.end());
  fixed_.resize(static_cast<std::size_t>(A.nodes), 0);
  const auto n = static_cast<std::size_t>(A.nodes);
  // Both triangles: entry 2 s is block s, 2 s + 1 its transpose.
  std::vector<std::int32_t> start(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::int32_t s = row_start_[i]; s < row_start_[i + 1]; ++s) {
      const auto j = static_cast<std::size_t>(column_[static_cast<std::size_t>(s)]);
      ++start[i + 1];
      if (j != i) ++start[j + 1];
    }
  for (std::size_t i = 0; i < n; ++i) start[i + 1] += start[i];
  std::vector<std::int32_t> entries(static_cast<std::size_t>(start[n])), columns = entries,
                                                                         next = start;
  const auto put = [&](std::size_t row, std::int32_t entry, std::size_t column) {
    const auto at = static_cast<std::size_t>(next[row]++);
    entries[at] = entry;
    columns[at] = static_cast<std::int32_t>(column);
  };
  for (std::size_t i = 0; i < n; ++i)
    for (std::int32_t s = row_start_[i]; s < row_start_[i + 1]; ++s) {
      const auto j = static_cast<std::size_t>(column_[static_cast<std::size_t>(s)]);
      put(i, 2 * s, j);
      if (j != i) put(j, 2 * s + 1, i);
    }
  full_start_.write(start);
  entries_.write(entries);
  columns_.write(columns);
  is_fixed_.write(fixed_);
  for (Numbers* v : {&b_, &x_, &r_, &z_, &p_, &q_}) v->reserve(3 * n);
  for (Numbers* s : {&size2_, &residual2_, &rz_[0], &rz_[1], &pq_}) s->reserve(groups);
  for (Numbers* m : {&kept_, &products_}) m->reserve(most_kept * 3 * n);
  kept_sums_.reserve(most_sums * groups);
  weights_.reserve(most_kept);
  device_.finish();  // of the vectors above
}

void Gradients::set_matrix(const NodeMatrixView& A, std::span<const char> fixed) {
  set_pattern(A, fixed);
  values_.write({A.values, 9 * column_.size()});
  unknown_products_ = all_unknown;
  device_.finish();  // of the values: the matrix may go before anything is read
}

void Gradients::set_elements(const TetElementsView& tets, const NodeMatrixView& pattern,
                             std::span<const char> fixed) {
  set_pattern(pattern, fixed);
  elements_.set(tets, pattern);
  values_.reserve(9 * column_.size());
}

void Gradients::assemble(const VecX& moved, Real scale, const VecX& diagonal, VecX& force,
                         std::vector<Mat3>& rotations) {
  elements_.assemble(moved, scale, diagonal, values_, force, rotations);
  unknown_products_ = all_unknown;
}

void Gradients::read_matrix(std::span<Real> values) {
  values_.read(values);
}

void Gradients::set_factor(const SupernodalFactor& factor) {
  then_is_there_ = false;
  solves_.set_factor(factor);
  row_of_.write(factor.row_of);
  known_position_.assign(static_cast<std::size_t>(3 * nodes_), -1);
  for (std::size_t k = 0; k < factor.row_of.size(); ++k)
    known_position_[static_cast<std::size_t>(factor.row_of[k])] = static_cast<std::int32_t>(k);
  position_.write(known_position_);
  for (Numbers* v : {&factor_b_, &factor_x_}) v->reserve(static_cast<std::size_t>(factor.size));
  device_.finish();
}

void Gradients::set_turns(std::span<const Mat3> turns) {
  turns_.write({turns.front().data(), 9 * turns.size()});
  device_.finish();
}

void Gradients::find_turns(std::span<const Mat3> of_factor) {
  if (!then_is_there_) {
    then_.write({of_factor.front().data(), 9 * of_factor.size()});
    device_.finish();
    then_is_there_ = true;
  }
  turns_.reserve(9 * of_factor.size());
  elements_.find_turns(then_, turns_);
}

void Gradients::entries_of_inverse(std::span<const Index> rows, std::span<const Index> columns,
                                   Eigen::Ref<MatX> entries) {
  const auto find = [&](std::span<const Index> unknowns, std::vector<std::int32_t>& positions) {
    positions.clear();
    for (const Index i : unknowns)
      positions.push_back(known_position_[static_cast<std::size_t>(i)]);
  };
  find(rows, entry_rows_);
  for (std::size_t first = 0; first < columns.size(); first += Solves::most_columns) {
    const std::size_t count =
        std::min(static_cast<std::size_t>(Solves::most_columns), columns.size() - first);
    find(columns.subspan(first, count), entry_columns_);
    solves_.entries_of_inverse(
        entry_rows_, entry_columns_,
        entries.middleCols(static_cast<Index>(first), static_cast<Index>(count)));
  }
}

void Gradients::product() {
  program_["product"](groups * items, items, nodes_, full_start_, entries_, columns_, values_,
                      is_fixed_, p_, q_, pq_, status_);
}

void Gradients::precondition(const Numbers& rz) {
  begin_preconditioning();
  finish_preconditioning(rz);
}

void Gradients::begin_preconditioning() {
  const auto size = static_cast<cl_int>(solves_.unknowns());
  program_["turn_back"](static_cast<std::size_t>(size), items, size, row_of_, turns_, r_, factor_b_,
                        status_);
  solves_.forward_small(factor_b_, factor_x_, status_);
}

void Gradients::finish_preconditioning(const Numbers& rz) {
  solves_.finish(factor_b_, factor_x_, status_);
  program_["turn"](groups * items, items, nodes_, position_, turns_, factor_x_, r_, z_, rz,
                   status_);
}

void Gradients::keep(const Eigen::Ref<const MatX>& x, Index next) {
  kept_count_ = static_cast<int>(x.cols());
  next_kept_ = static_cast<int>(next);
  unknown_products_ = all_unknown;
  if (kept_count_ == 0) return;
  assert(x.outerStride() == x.rows());
  kept_.write_at(0, {x.data(), static_cast<std::size_t>(x.size())});
  device_.finish();
}

GradientStatus* Gradients::start(const Eigen::Ref<const VecX>& b) {
  auto* status = new (statuses_.data()) GradientStatus[2];
  status_.write(&status[1], sizeof(status[1]));
  b_.write(b);
  const cl_int count = kept_count_;
  if (count > 0) {
    constexpr std::size_t all = groups * items;
    const auto columns = static_cast<std::size_t>(count),
               sums = static_cast<std::size_t>(sums_of(count));
    program_["kept_products"](columns * all, items, nodes_, unknown_products_, full_start_,
                              entries_, columns_, values_, is_fixed_, kept_, products_);
    unknown_products_ = 0;
    program_["kept_sums"](sums * all, items, count, 3 * nodes_, kept_, products_, b_, kept_sums_);
    program_["kept_weights"](items, items, count, kept_sums_, weights_);
  }
  program_["start"](groups * items, items, nodes_, count, weights_, kept_, products_, is_fixed_, b_,
                    x_, r_, size2_, residual2_);
  return status;
}

/// In place of the oldest one; `x` is on the device too.
void Gradients::keep_answer(const Eigen::Ref<const VecX>& x) {
  if (!x.allFinite() || x.isZero(0)) return;
  program_["keep"](groups * items, items, next_kept_, 3 * nodes_, x_, kept_);
  unknown_products_ |= 1 << next_kept_;
  kept_count_ = std::min(kept_count_ + 1, most_kept);
  next_kept_ = (next_kept_ + 1) % most_kept;
}

void Gradients::begin(const Eigen::Ref<const VecX>& b) {
  start(b);
  device_.finish();
}

ConjugateGradientDevice::Report Gradients::solve(const Eigen::Ref<const VecX>& b,
                                                 Eigen::Ref<VecX> x, Real tolerance,
                                                 Index max_iterations) {
  const auto rows = static_cast<cl_int>(3 * nodes_), most = static_cast<cl_int>(max_iterations);
  const GradientStatus* status = start(b);
  constexpr std::size_t all = groups * items;
  const auto look = [&](cl_int iteration) {
    program_["look"](items, items, iteration, tolerance, most, size2_, residual2_, status_);
  };
  look(0);
  // The residual is on its way while the first kernels of the next iteration run already: the
  // device does not wait. Once it is done, they return at once.
  Event known;
  for (int k = 1; k <= most + 1; ++k) {
    status_.read_later(statuses_.data(), sizeof(GradientStatus), known);
    begin_preconditioning();
    known.wait(device_);
    if (status->done) break;
    const Numbers &rz = rz_[k & 1], &rz_before = rz_[(k & 1) ^ 1];
    finish_preconditioning(rz);
    program_["direction"](all, items, k == 1 ? 1 : 0, rows, rz, rz_before, z_, p_, status_);
    product();
    program_["advance"](all, items, rows, rz, pq_, p_, q_, x_, r_, residual2_, status_);
    look(k);
  }
  x_.read(x);
  const bool exact = real_ == sizeof(double);
  const Real size = exact ? status->exact[0] : Real{status->rounded[0]},
             left = exact ? status->exact[1] : Real{status->rounded[1]};
  ConjugateGradientDevice::Report report;
  report.iterations = status->iterations;
  report.residual = size > 0 ? left / size : Real(0);
  report.converged = status->failed == 0 && report.residual <= tolerance;
  if (report.converged) keep_answer(x);
  return report;
}

}  // namespace sutura::opencl
