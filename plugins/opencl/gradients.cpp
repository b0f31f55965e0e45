#include "gradients.h"

#include <algorithm>
#include <new>
#include <type_traits>

#include "programs.h"

namespace sutura::opencl {
namespace {

constexpr std::size_t items = 256, groups = 128;  // of sums over all nodes

}  // namespace

struct Gradients::Program {
  Program(const Device& device, Precision precision)
      : program(
            device.build(definitions(precision) + programs::gradients, "-DITEMS=256 -DGROUPS=128")),
        start(device, program, "start"),
        look(device, program, "look"),
        turn_back(device, program, "turn_back"),
        turn(device, program, "turn"),
        direction(device, program, "direction"),
        product(device, program, "product"),
        advance(device, program, "advance") {}
  ~Program() { clReleaseProgram(program); }
  cl_program program;
  Kernel start, look, turn_back, turn, direction, product, advance;
};

Gradients::Gradients(const Device& device, Precision precision)
    : device_(device),
      precision_(precision),
      solves_(device, precision),
      elements_(device, precision),
      contacts_(device, precision),
      full_start_(device),
      entries_(device),
      columns_(device),
      is_fixed_(device),
      values_(device),
      then_(device),
      turns_(device),
      row_of_(device),
      position_(device),
      b_(device),
      x_(device),
      r_(device),
      z_(device),
      p_(device),
      q_(device),
      factor_b_(device),
      factor_x_(device),
      size2_(device),
      residual2_(device),
      rz_{Buffer(device), Buffer(device)},
      pq_(device),
      status_(device),
      statuses_(device, 2 * sizeof(GradientStatus<double>)) {}

Gradients::~Gradients() {
  device_.drain();
}

template <class T>
void Gradients::write_as(Buffer& to, const Real* from, std::size_t count) {
  if constexpr (std::is_same_v<T, Real>) {
    to.write(from, count * sizeof(Real));
  } else {
    rounded_.assign(from, from + count);
    to.write(rounded_);
    device_.finish();  // `rounded_` may change from now on
  }
}

void Gradients::write_reals(Buffer& to, const Real* from, std::size_t count) {
  if (has_double_sums(precision_))
    write_as<double>(to, from, count);
  else
    write_as<float>(to, from, count);
}

void Gradients::set_pattern(const NodeMatrixView& A, std::span<const char> fixed) {
  if (!program_) program_ = std::make_unique<Program>(device_, precision_);
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
  const std::size_t real = has_double_sums(precision_) ? 8 : 4, vector = 3 * n * real;
  for (Buffer* b : {&b_, &x_, &r_, &z_, &p_, &q_}) b->reserve(vector);
  for (Buffer* b : {&size2_, &residual2_, &rz_[0], &rz_[1], &pq_}) b->reserve(groups * real);
  device_.finish();  // of the vectors above
}

void Gradients::set_matrix(const NodeMatrixView& A, std::span<const char> fixed) {
  set_pattern(A, fixed);
  const std::size_t count = 9 * column_.size();
  if (stores_double(precision_))
    write_as<double>(values_, A.values, count);
  else
    write_as<float>(values_, A.values, count);
  device_.finish();  // of the values: the matrix may go before anything is read
}

void Gradients::set_elements(const TetElementsView& tets, const NodeMatrixView& pattern,
                             std::span<const char> fixed) {
  set_pattern(pattern, fixed);
  elements_.set(tets, pattern);
  values_.reserve(9 * column_.size() * (stores_double(precision_) ? 8 : 4));
}

void Gradients::assemble(const VecX& moved, Real scale, const VecX& diagonal, VecX& force,
                         std::vector<Mat3>& rotations) {
  elements_.assemble(moved, scale, diagonal, values_, force, rotations);
}

void Gradients::read_matrix(std::span<Real> values) {
  if (stores_double(precision_)) return values_.read(values.data(), values.size_bytes());
  rounded_.resize(values.size());
  values_.read(rounded_);
  std::copy(rounded_.begin(), rounded_.end(), values.begin());
}

void Gradients::set_factor(const SupernodalFactor& factor) {
  then_is_there_ = false;
  solves_.set_factor(factor);
  row_of_.write(factor.row_of);
  known_position_.assign(static_cast<std::size_t>(3 * nodes_), -1);
  for (std::size_t k = 0; k < factor.row_of.size(); ++k)
    known_position_[static_cast<std::size_t>(factor.row_of[k])] = static_cast<std::int32_t>(k);
  position_.write(known_position_);
  const std::size_t real = has_double_sums(precision_) ? 8 : 4;
  for (Buffer* b : {&factor_b_, &factor_x_})
    b->reserve(static_cast<std::size_t>(factor.size) * real);
  device_.finish();
}

void Gradients::set_turns(std::span<const Mat3> turns) {
  write_reals(turns_, turns.front().data(), 9 * turns.size());
  device_.finish();
}

void Gradients::find_turns(std::span<const Mat3> of_factor) {
  if (!then_is_there_) {
    write_reals(then_, of_factor.front().data(), 9 * of_factor.size());
    device_.finish();
    then_is_there_ = true;
  }
  turns_.reserve(9 * of_factor.size() * (has_double_sums(precision_) ? 8 : 4));
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
  program_->product(groups * items, items, nodes_, full_start_, entries_, columns_, values_,
                    is_fixed_, p_, q_, pq_, status_);
}

void Gradients::precondition(const Buffer& rz) {
  begin_preconditioning();
  finish_preconditioning(rz);
}

void Gradients::begin_preconditioning() {
  const auto size = static_cast<cl_int>(solves_.unknowns());
  program_->turn_back(static_cast<std::size_t>(size), items, size, row_of_, turns_, r_, factor_b_,
                      status_);
  solves_.forward_small(factor_b_, factor_x_, status_);
}

void Gradients::finish_preconditioning(const Buffer& rz) {
  solves_.finish(factor_b_, factor_x_, status_);
  program_->turn(groups * items, items, nodes_, position_, turns_, factor_x_, r_, z_, rz, status_);
}

template <class T>
GradientStatus<T>* Gradients::start(const Eigen::Ref<const VecX>& b) {
  auto* status = new (statuses_.data()) GradientStatus<T>[2];
  status_.write(&status[1], sizeof(status[1]));
  write_as<T>(b_, b.data(), static_cast<std::size_t>(3 * nodes_));
  program_->start(groups * items, items, nodes_, is_fixed_, b_, x_, r_, size2_, residual2_);
  return status;
}

void Gradients::begin(const Eigen::Ref<const VecX>& b) {
  if (has_double_sums(precision_))
    start<double>(b);
  else
    start<float>(b);
  device_.finish();
}

template <class T>
ConjugateGradientDevice::Report Gradients::solve_with(const Eigen::Ref<const VecX>& b,
                                                      Eigen::Ref<VecX> x, Real tolerance,
                                                      Index max_iterations) {
  const auto rows = static_cast<std::size_t>(3 * nodes_);
  const auto most = static_cast<int>(max_iterations);
  GradientStatus<T>* status = start<T>(b);
  Program& p = *program_;
  constexpr std::size_t all = groups * items;
  const auto look = [&](int iteration) {
    p.look(items, items, iteration, static_cast<T>(tolerance), most, size2_, residual2_, status_);
  };
  look(0);
  // The residual is on its way while the first kernels of the next iteration run already: the
  // device does not wait. Once it is done, they return at once.
  Event known;
  for (int k = 1; k <= most + 1; ++k) {
    status_.read_later(&status[0], sizeof(status[0]), known);
    begin_preconditioning();
    known.wait(device_);
    if (status[0].done) break;
    finish_preconditioning(rz_[k & 1]);
    p.direction(all, items, k == 1 ? 1 : 0, static_cast<cl_int>(rows), rz_[k & 1], rz_[(k & 1) ^ 1],
                z_, p_, status_);
    product();
    p.advance(all, items, static_cast<cl_int>(rows), rz_[k & 1], pq_, p_, q_, x_, r_, residual2_,
              status_);
    look(k);
  }
  if constexpr (std::is_same_v<T, Real>) {
    x_.read(x.data(), rows * sizeof(T));
  } else {
    rounded_.resize(rows);
    x_.read(rounded_);
    for (std::size_t i = 0; i < rows; ++i) x[static_cast<Index>(i)] = rounded_[i];
  }
  const GradientStatus<T>& end = status[0];
  ConjugateGradientDevice::Report report;
  report.iterations = end.iterations;
  report.residual =
      end.size > 0 ? static_cast<Real>(end.residual) / static_cast<Real>(end.size) : Real(0);
  report.converged = end.failed == 0 && report.residual <= tolerance;
  return report;
}

ConjugateGradientDevice::Report Gradients::solve(const Eigen::Ref<const VecX>& b,
                                                 Eigen::Ref<VecX> x, Real tolerance,
                                                 Index max_iterations) {
  if (has_double_sums(precision_)) return solve_with<double>(b, x, tolerance, max_iterations);
  return solve_with<float>(b, x, tolerance, max_iterations);
}

}  // namespace sutura::opencl
