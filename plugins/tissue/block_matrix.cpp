#include "block_matrix.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>

#include "lanes.h"

namespace sutura::tissue {

NodePattern::NodePattern(Index nodes, std::span<const std::array<Index, 2>> pairs) {
  std::vector<std::array<Index, 2>> all;
  all.reserve(pairs.size() + static_cast<std::size_t>(nodes));
  for (Index i = 0; i < nodes; ++i) all.push_back({i, i});
  for (const auto& p : pairs) {
    assert(p[0] >= 0 && p[1] >= 0 && std::max(p[0], p[1]) < nodes);
    all.push_back({std::min(p[0], p[1]), std::max(p[0], p[1])});
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());

  row_start_.assign(static_cast<std::size_t>(nodes) + 1, 0);
  column_.reserve(all.size());
  for (const auto& p : all) {
    ++row_start_[static_cast<std::size_t>(p[0]) + 1];
    column_.push_back(static_cast<std::int32_t>(p[1]));
  }
  for (std::size_t i = 1; i < row_start_.size(); ++i) row_start_[i] += row_start_[i - 1];
}

Index NodePattern::slot(Index i, Index j) const {
  assert(i <= j);
  const auto first = column_.begin() + row_start_[static_cast<std::size_t>(i)];
  const auto last = column_.begin() + row_start_[static_cast<std::size_t>(i) + 1];
  const auto it = std::lower_bound(first, last, static_cast<std::int32_t>(j));
  return it != last && *it == j ? it - column_.begin() : -1;
}

std::vector<std::array<Index, 2>> pairs_of_elements(std::span<const Index> element_nodes,
                                                    Index size) {
  std::vector<std::array<Index, 2>> pairs;
  const auto n = static_cast<std::size_t>(size);
  assert(element_nodes.size() % n == 0);
  for (std::size_t e = 0; e < element_nodes.size(); e += n)
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = a + 1; b < n; ++b) {
        const Index i = element_nodes[e + a], j = element_nodes[e + b];
        if (i != j) pairs.push_back({std::min(i, j), std::max(i, j)});
      }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

NodeMatrix::NodeMatrix(std::shared_ptr<const NodePattern> pattern)
    : pattern_(std::move(pattern)),
      values_(static_cast<std::size_t>(9 * pattern_->slots() + 1), Real(0)) {}

NodeMatrix::NodeMatrix(const NodeMatrix& other) : pattern_(other.pattern_) {
  *this = other;
}

NodeMatrix& NodeMatrix::operator=(const NodeMatrix& other) {
  if (this == &other) return *this;
  other.bring();
  pattern_ = other.pattern_;
  values_ = other.values_;
  is_there_ = false;
  is_here_ = true;
  return *this;
}

void NodeMatrix::leave_there(MatrixSource& source) {
  source_ = &source;
  is_there_ = true;
  is_here_ = false;
}

/// The numbers are what they were: a matrix that was left there is still the same.
void NodeMatrix::bring() const {
  if (is_here_) return;
  is_here_ = true;
  source_->bring(const_cast<NodeMatrix&>(*this));
}

void NodeMatrix::set_zero() {
  is_here_ = true;
  is_there_ = false;
  std::fill(values_.begin(), values_.end(), Real(0));
}

void NodeMatrix::add_diagonal(std::span<const Real> m, Real scale) {
  for (Index i = 0; i < nodes(); ++i) {
    Real* d = values() + 9 * pattern_->diagonal(i);
    const Real s = scale * m[static_cast<std::size_t>(i)];
    d[0] += s;
    d[4] += s;
    d[8] += s;
  }
}

Mat3 NodeMatrix::block(Index i, Index j) const {
  const Index s = slot(std::min(i, j), std::max(i, j));
  if (s < 0) return Mat3::Zero();
  const Eigen::Map<const Eigen::Matrix<Real, 3, 3, Eigen::RowMajor>> b(values() + 9 * s);
  return i <= j ? Mat3(b) : Mat3(b.transpose());
}

void NodeMatrix::multiply(const VecX& x, VecX& y) const {
  const std::size_t n = static_cast<std::size_t>(nodes());
  assert(x.size() == 3 * nodes());
  y.resize(x.size());
  // One register per node, three numbers and a zero (in x) or rubbish (in y): a row of a block is
  // read together with the first number of the next row, which then does no harm.
  struct Packed {
    Lanes at;
  };
  thread_local std::vector<Packed> in, out;
  in.resize(n);
  out.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Real* v = x.data() + 3 * i;
    in[i].at = Lanes{v[0], v[1], v[2], 0};
    out[i].at = Lanes{};
  }
  const auto row = [](const Real* p) {
    Lanes r;
    std::memcpy(&r, p, sizeof r);
    return r;
  };
  const std::int32_t* start = pattern_->row_start().data();
  const std::int32_t* column = pattern_->column().data();
  const Real* values = this->values();
  for (std::size_t i = 0; i < n; ++i) {
    // Row i collects block * x_j in registers; the transposed block adds to y_j at once.
    const Lanes xi = in[i].at;
    const Lanes x0 = Lanes{} + xi[0], x1 = Lanes{} + xi[1], x2 = Lanes{} + xi[2];
    const Real* b = values + 9 * static_cast<std::size_t>(start[i]);
    Lanes y0 = row(b) * xi, y1 = row(b + 3) * xi, y2 = row(b + 6) * xi;
    for (std::int32_t k = start[i] + 1; k < start[i + 1]; ++k) {
      b += 9;
      const auto j = static_cast<std::size_t>(column[k]);
      const Lanes r0 = row(b), r1 = row(b + 3), r2 = row(b + 6), xj = in[j].at;
      y0 += r0 * xj;
      y1 += r1 * xj;
      y2 += r2 * xj;
      out[j].at += r0 * x0 + r1 * x1 + r2 * x2;
    }
    Real* at = y.data() + 3 * i;  // row i is complete: all its transposed blocks came before
    at[0] = out[i].at[0] + (y0[0] + y0[1] + y0[2]);
    at[1] = out[i].at[1] + (y1[0] + y1[1] + y1[2]);
    at[2] = out[i].at[2] + (y2[0] + y2[1] + y2[2]);
  }
}

}  // namespace sutura::tissue
