#include "compliance.h"

#include <algorithm>
#include <limits>

#include "factor.h"
#include "sutura/growing.h"
#include "tissue_solver.h"

namespace sutura::tissue {
namespace {

constexpr Index never = std::numeric_limits<Index>::min() / 2;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

constexpr auto chunk = static_cast<std::size_t>(Factor::columns_at_once);

/// The columns A^-1 H^T of the rows listed in `outside`, and what they add to W.
void add_solved_rows(TissueSolver& solver, const BodyRows& rows, const std::vector<Index>& outside,
                     const std::vector<char>& is_outside, Index dofs, Real dt, Eigen::Ref<MatX> W) {
  thread_local MatX columns;  // keeps its memory from step to step
  columns.resize(dofs, chunk);
  for (std::size_t first = 0; first < outside.size(); first += chunk) {
    const std::size_t count = std::min(chunk, outside.size() - first);
    auto block = columns.leftCols(static_cast<Index>(count));
    block.setZero();
    for (std::size_t j = 0; j < count; ++j) {
      const Index r = outside[first + j];
      for (Index e = rows.start[at(r)]; e < rows.start[at(r + 1)]; ++e)
        block.col(static_cast<Index>(j)).segment<3>(3 * rows.node[at(e)]) +=
            Eigen::Map<const Vec3>(&rows.value[at(3 * e)]);
    }
    solver.solve_as_compliance(block);
    for (std::size_t j = 0; j < count; ++j) {
      const Index r = outside[first + j];
      for (Index i = 0; i < rows.size(); ++i) {
        if (is_outside[at(i)] && i > r) continue;  // that pair belongs to the later column
        Real w = 0;
        for (Index e = rows.start[at(i)]; e < rows.start[at(i + 1)]; ++e)
          w += block.col(static_cast<Index>(j))
                   .segment<3>(3 * rows.node[at(e)])
                   .dot(Eigen::Map<const Vec3>(&rows.value[at(3 * e)]));
        w *= dt * dt;
        W(rows.row[at(i)], rows.row[at(r)]) += w;
        if (i != r) W(rows.row[at(r)], rows.row[at(i)]) += w;
      }
    }
  }
}

/// Q^T h, per entry.
void turn_back(const NodeCompliance& compliance, const BodyRows& rows, std::vector<Vec3>& turned) {
  turned.resize(rows.node.size());
  for (std::size_t e = 0; e < rows.node.size(); ++e) {
    const Eigen::Map<const Vec3> h(&rows.value[3 * e]);
    turned[e] =
        compliance.now.empty() ? Vec3(h) : Vec3(compliance.turn(rows.node[e]).transpose() * h);
  }
}

/// All rows, of candidates only, on the device of the solver. False: they are to be added here.
bool add_rows_on_device(TissueSolver& solver, const NodeCompliance& compliance,
                        const BodyRows& rows, Real dt, Eigen::Ref<MatX> W) {
  constexpr Index few = 100;  // rows, which take less time here than on the way there
  if (solver.device() == nullptr || rows.size() < few) return false;
  thread_local std::vector<Vec3> turned;
  thread_local std::vector<std::int32_t> first, place;
  turn_back(compliance, rows, turned);
  first.assign(rows.start.begin(), rows.start.end());
  place.clear();
  for (const Index node : rows.node)
    place.push_back(static_cast<std::int32_t>(compliance.number[at(node)]));
  return solver.add_on_device({first, place, {turned.front().data(), 3 * turned.size()}, rows.row},
                              dt * dt, W);
}

/// Rows of candidates only: W += h^2 (H Q) C (H Q)^T.
void add_candidate_rows(const NodeCompliance& compliance, const BodyRows& rows,
                        const std::vector<char>& is_outside, Real dt, Eigen::Ref<MatX> W) {
  const NodeCompliance::Matrix& C = compliance.C;
  thread_local std::vector<Vec3> turned;  // keeps its memory
  thread_local GrowingVec y;
  turn_back(compliance, rows, turned);
  y.resize(C.rows());
  for (Index r = 0; r < rows.size(); ++r) {
    if (is_outside[at(r)]) continue;
    y.setZero();
    for (Index e = rows.start[at(r)]; e < rows.start[at(r + 1)]; ++e) {
      const Index k = compliance.number[at(rows.node[at(e)])];
      if (k < 0) continue;  // fixed
      const Vec3& h = turned[at(e)];
      y += C.col(3 * k) * h.x() + C.col(3 * k + 1) * h.y() + C.col(3 * k + 2) * h.z();
    }
    for (Index i = 0; i <= r; ++i) {
      if (is_outside[at(i)]) continue;
      Real w = 0;
      for (Index e = rows.start[at(i)]; e < rows.start[at(i + 1)]; ++e) {
        const Index k = compliance.number[at(rows.node[at(e)])];
        if (k >= 0) w += y.segment<3>(3 * k).dot(turned[at(e)]);
      }
      w *= dt * dt;
      W(rows.row[at(i)], rows.row[at(r)]) += w;
      if (i != r) W(rows.row[at(r)], rows.row[at(i)]) += w;
    }
  }
}

/// The nodes that rows touch, as candidates for this once.
class SolvedNodes {
 public:
  void choose(const TissueSolver& solver, const BodyRows& rows) {
    number_.assign(at(solver.nodes()), -1);
    nodes_.clear();
    for (const Index node : rows.node) {
      if (number_[at(node)] >= 0 || solver.is_fixed(node)) continue;
      number_[at(node)] = static_cast<Index>(nodes_.size());
      nodes_.push_back(node);
    }
  }
  std::size_t unknowns() const { return 3 * nodes_.size(); }
  NodeCompliance compliance(TissueSolver& solver) {
    const std::size_t count = unknowns();
    // Grow only: a larger one serves fewer nodes without asking for memory.
    if (C_.rows() < static_cast<Index>(count))
      C_.setZero(static_cast<Index>(count), static_cast<Index>(count));
    columns_.resize(3 * solver.nodes(), chunk);
    for (std::size_t first = 0; first < count; first += chunk) {
      const std::size_t width = std::min(chunk, count - first);
      auto block = columns_.leftCols(static_cast<Index>(width));
      block.setZero();
      for (std::size_t j = 0; j < width; ++j) {
        const std::size_t unknown = first + j;
        block(3 * nodes_[unknown / 3] + static_cast<Index>(unknown % 3), static_cast<Index>(j)) = 1;
      }
      solver.solve_as_compliance(block);
      for (std::size_t j = 0; j < width; ++j)
        for (std::size_t i = 0; i < nodes_.size(); ++i)
          C_.col(static_cast<Index>(first + j)).segment<3>(static_cast<Index>(3 * i)) =
              block.col(static_cast<Index>(j)).segment<3>(3 * nodes_[i]);
    }
    NodeCompliance out;
    out.see(C_, static_cast<Index>(count));
    out.number = number_;
    return out;
  }

 private:
  std::vector<Index> nodes_, number_;
  MatX C_, columns_;
};

}  // namespace

void Candidates::reset(std::shared_ptr<const NodePattern> pattern, std::span<const char> fixed,
                       std::span<const Index> from_the_start) {
  pattern_ = std::move(pattern);
  const std::size_t n = at(pattern_->nodes());
  fixed_.assign(n, 0);
  std::copy(fixed.begin(), fixed.end(), fixed_.begin());
  touched_at_.assign(n, never);
  is_chosen_.assign(n, 0);
  chosen_.clear();
  chosen_.reserve(n);  // all nodes may be touched before only `limit` of them are kept
  full_until_ = never;
  for (const Index i : from_the_start)
    if (!fixed_[at(i)] && !is_chosen_[at(i)]) {
      is_chosen_[at(i)] = 1;
      chosen_.push_back(i);
    }
  outgrown_ = false;
}

void Candidates::touch(std::span<const Index> nodes, Index step) {
  for (const Index i : nodes) {
    touched_at_[at(i)] = step;
    if (!is_chosen_[at(i)] && !fixed_[at(i)] && step >= full_until_) outgrown_ = true;
  }
}

void Candidates::choose(Index step) {
  chosen_.clear();
  is_chosen_.assign(is_chosen_.size(), 0);
  for (Index i = 0; i < pattern_->nodes(); ++i)
    if (touched_at_[at(i)] >= step - memory && !fixed_[at(i)]) chosen_.push_back(i);
  std::sort(chosen_.begin(), chosen_.end(), [&](Index a, Index b) {
    return touched_at_[at(a)] != touched_at_[at(b)] ? touched_at_[at(a)] > touched_at_[at(b)]
                                                    : a < b;
  });
  if (static_cast<Index>(chosen_.size()) >= limit) {
    chosen_.resize(at(limit));
    full_until_ = step + memory;
  }
  for (const Index i : chosen_) is_chosen_[at(i)] = 1;

  // A contact that moves goes to a neighbour next.
  const auto grow = [&](Index i) {
    if (static_cast<Index>(chosen_.size()) >= limit || is_chosen_[at(i)] || fixed_[at(i)]) return;
    is_chosen_[at(i)] = 1;
    chosen_.push_back(i);
  };
  is_touched_ = is_chosen_;
  for (Index i = 0; i < pattern_->nodes(); ++i)
    for (std::int32_t k = pattern_->row_start()[at(i)] + 1; k < pattern_->row_start()[at(i + 1)];
         ++k) {
      const Index j = pattern_->column()[at(k)];
      if (is_touched_[at(i)]) grow(j);
      if (is_touched_[at(j)]) grow(i);
    }
  outgrown_ = false;
}

Index add_tissue_compliance(TissueSolver& solver, const BodyRows& rows, Real dt,
                            Eigen::Ref<MatX> W) {
  if (rows.size() == 0) return 0;
  const Index learnt = solver.touch(rows.node);
  const NodeCompliance compliance = solver.compliance();
  thread_local std::vector<char> is_outside;
  thread_local std::vector<Index> outside;
  is_outside.assign(at(rows.size()), 0);
  outside.clear();
  for (Index r = 0; r < rows.size(); ++r) {
    for (Index e = rows.start[at(r)]; e < rows.start[at(r + 1)]; ++e) {
      const Index node = rows.node[at(e)];
      if (!compliance.is_known(node) && (compliance.C.size() == 0 || !solver.is_fixed(node)))
        is_outside[at(r)] = 1;
    }
    if (is_outside[at(r)]) outside.push_back(r);
  }
  // Many rows on few nodes, as those of a thread that has come to lie: the nodes are fewer columns.
  thread_local SolvedNodes solved;
  if (!outside.empty()) solved.choose(solver, rows);
  if (!outside.empty() && solved.unknowns() < outside.size()) {
    is_outside.assign(at(rows.size()), 0);
    add_candidate_rows(solved.compliance(solver), rows, is_outside, dt, W);
    return learnt + static_cast<Index>(solved.unknowns());
  }
  if (outside.empty() && add_rows_on_device(solver, compliance, rows, dt, W)) return learnt;
  if (compliance.C.size() > 0) add_candidate_rows(compliance, rows, is_outside, dt, W);
  if (!outside.empty())
    add_solved_rows(solver, rows, outside, is_outside, 3 * solver.nodes(), dt, W);
  return learnt + static_cast<Index>(outside.size());
}

}  // namespace sutura::tissue
