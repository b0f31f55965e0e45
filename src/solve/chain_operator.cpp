#include "solve/chain_operator.h"

#include <algorithm>
#include <bit>

namespace sutura {

void ChainOperator::prepare(const ConstraintProblem& problem, const ChainCompliance& chain,
                            const BodyRows& rows) {
  chain_ = &chain;
  tree_built_ = false;
  const auto t = static_cast<std::size_t>(chain.size());
  leaves_ = std::bit_ceil(std::max<std::size_t>(t, 1));
  levels_ = std::bit_width(leaves_) - 1;
  force_.resize(t);
  motion_.resize(t);

  if (t > 0 && place_of_node_.size() <= static_cast<std::size_t>(chain.node.back()))
    place_of_node_.resize(static_cast<std::size_t>(chain.node.back()) + 1, -1);
  for (std::size_t a = 0; a < t; ++a)
    place_of_node_[static_cast<std::size_t>(chain.node[a])] = static_cast<Index>(a);
  blocks_.clear();
  place_.clear();
  value_.clear();
  std::size_t row = 0;
  for (const ConstraintBlock& b : problem.blocks) read_block(b, rows, row);
  for (const Index node : chain.node) place_of_node_[static_cast<std::size_t>(node)] = -1;
}

/// The rows of one block, from `row` on: their coefficients by node, nodes in the order of the
/// chain.
void ChainOperator::read_block(const ConstraintBlock& block, const BodyRows& rows,
                               std::size_t& row) {
  BlockRows out{block.first_row, block.law->dim, 0, place_.size(), value_.size()};
  const auto dim = static_cast<std::size_t>(out.dim);
  for (; row < rows.row.size() && rows.row[row] < block.first_row + block.law->dim; ++row) {
    const auto k = static_cast<std::size_t>(rows.row[row] - block.first_row);
    for (auto e = static_cast<std::size_t>(rows.start[row]);
         e < static_cast<std::size_t>(rows.start[row + 1]); ++e) {
      const auto node = static_cast<std::size_t>(rows.node[e]);
      const Index place = node < place_of_node_.size() ? place_of_node_[node] : -1;
      if (place < 0) continue;  // cannot move
      const auto begin = place_.begin() + static_cast<std::ptrdiff_t>(out.first_slot);
      const auto found = std::lower_bound(begin, place_.end(), place);
      const auto slot = static_cast<std::size_t>(found - begin);
      if (found == place_.end() || *found != place) {
        place_.insert(found, place);
        value_.insert(value_.begin() + static_cast<std::ptrdiff_t>(out.first_value + slot * dim),
                      dim, Vec6::Zero());
        ++out.slots;
      }
      value_[out.first_value + slot * dim + k] += Eigen::Map<const Vec6>(&rows.value[6 * e]);
    }
  }
  blocks_.push_back(out);
}

void ChainOperator::add_diagonal(std::size_t block, Real* W) {
  // For rows k, l of the block, with z^k what the force of row k sends to the left:
  //   W_kl = sum over its nodes of  h^k own h^l + h^k z^l + h^l z^k.
  const BlockRows& b = blocks_[block];
  const auto dim = static_cast<std::size_t>(b.dim);
  Vec6 left[max_block_dim], own[max_block_dim];
  for (std::size_t k = 0; k < dim; ++k) left[k].setZero();
  for (int s = b.slots; s-- > 0;) {
    const Index a = place_[b.first_slot + static_cast<std::size_t>(s)];
    const Vec6* h = &value_[b.first_value + static_cast<std::size_t>(s) * dim];
    for (std::size_t k = 0; k < dim; ++k)
      own[k].noalias() = chain_->own[static_cast<std::size_t>(a)] * h[k];
    for (std::size_t l = 0; l < dim; ++l)
      for (std::size_t k = 0; k <= l; ++k) {
        const Real w = h[k].dot(own[l]) + (h[k].dot(left[l]) + h[l].dot(left[k]));
        W[k + l * dim] += w;
        if (k != l) W[l + k * dim] += w;
      }
    if (s == 0) return;
    const Index next = place_[b.first_slot + static_cast<std::size_t>(s) - 1];
    for (std::size_t k = 0; k < dim; ++k) carry(next, a, left[k] += own[k]);
  }
}

void ChainOperator::multiply(const VecX& lambda, VecX& delta) {
  for (Vec6& f : force_) f.setZero();
  for (const BlockRows& b : blocks_) {
    const Vec6* h = value_.data() + b.first_value;
    for (int s = 0; s < b.slots; ++s)
      for (int k = 0; k < b.dim; ++k, ++h)
        force_[static_cast<std::size_t>(place_[b.first_slot + static_cast<std::size_t>(s)])] +=
            lambda[b.first_row + k] * *h;
  }
  const std::size_t t = force_.size();
  Vec6 passed = Vec6::Zero(), sum;
  for (std::size_t a = 0; a < t; ++a) {
    sum = force_[a] + passed;
    motion_[a].noalias() = chain_->own[a] * sum;
    if (a + 1 < t) passed.noalias() = chain_->transfer[a].transpose() * sum;
  }
  passed.setZero();
  for (std::size_t a = t; a-- > 1;) {
    motion_[a] += passed;
    sum = passed;
    sum.noalias() += chain_->own[a] * force_[a];
    passed.noalias() = chain_->transfer[a - 1] * sum;
  }
  if (t > 0) motion_[0] += passed;
  for (const BlockRows& b : blocks_) {
    const Vec6* h = value_.data() + b.first_value;
    for (int s = 0; s < b.slots; ++s)
      for (int k = 0; k < b.dim; ++k, ++h)
        delta[b.first_row + k] += h->dot(
            motion_[static_cast<std::size_t>(place_[b.first_slot + static_cast<std::size_t>(s)])]);
  }
  products_ += static_cast<Index>(4 * t);
}

// --- the tree
// -------------------------------------------------------------------------------------------------

void ChainOperator::build_tree() {
  tree_built_ = true;
  const auto t = force_.size();
  across_.resize(2 * leaves_);
  for (std::size_t a = 0; a < leaves_; ++a) {
    if (a < t)
      across_[leaves_ + a] = chain_->transfer[a];
    else
      across_[leaves_ + a].setZero();
  }
  // Beyond the last node there is nothing: a stretch that holds it passes nothing on.
  std::size_t first = leaves_, width = 1;  // of the children's level
  for (std::size_t s = leaves_; s-- > 1;) {
    if (2 * s < first) first /= 2, width *= 2;
    if ((2 * s + 2 - first) * width >= t)
      across_[s].setZero();
    else
      across_[s].noalias() = across_[2 * s] * across_[2 * s + 1];
  }
}

void ChainOperator::carry(Index from, Index to, Vec6& v) {
  if (to - from > 1 && !tree_built_) build_tree();
  const auto apply = [&](const Mat6& m) {
    const Vec6 before = v;
    v.noalias() = m * before;
    ++products_;
  };
  if (to - from == 1) return apply(chain_->transfer[static_cast<std::size_t>(from)]);
  // Whole stretches from the right end inwards, then those of the left end from inside out.
  std::size_t l = leaves_ + static_cast<std::size_t>(from),
              r = leaves_ + static_cast<std::size_t>(to);
  std::size_t left[64];
  int lefts = 0;
  for (; l < r; l /= 2, r /= 2) {
    if (l & 1) left[lefts++] = l++;
    if (r & 1) apply(across_[--r]);
  }
  while (lefts > 0) apply(across_[left[--lefts]]);
}

void ChainOperator::begin_sweep() {
  if (force_.empty()) return;
  if (!tree_built_) build_tree();
  message_.resize(2 * leaves_);
  outside_.resize(static_cast<std::size_t>(levels_) + 1);
  outside_.back().force.setZero();
  outside_.back().motion.setZero();
  for (std::size_t a = 0; a < leaves_; ++a) {
    Message& m = message_[leaves_ + a];
    if (a >= force_.size()) {
      m.force.setZero();
      m.motion.setZero();
      continue;
    }
    m.force.noalias() = chain_->transfer[a].transpose() * force_[a];
    m.motion.noalias() = chain_->own[a] * force_[a];
  }
  for (std::size_t s = leaves_; s-- > 2;) {
    const Message &l = message_[2 * s], &r = message_[2 * s + 1];
    Message& m = message_[s];
    m.force = r.force;
    m.force.noalias() += across_[2 * s + 1].transpose() * l.force;
    m.motion = l.motion;
    m.motion.noalias() += across_[2 * s] * r.motion;
  }
  products_ += static_cast<Index>(2 * force_.size() + 2 * leaves_);
}

void ChainOperator::add_displacement(std::size_t block, Real* delta) {
  const BlockRows& b = blocks_[block];
  const Vec6* h = value_.data() + b.first_value;
  std::size_t before = 0;
  for (int s = 0; s < b.slots; ++s) {
    const auto a = static_cast<std::size_t>(place_[b.first_slot + static_cast<std::size_t>(s)]);
    const std::size_t leaf = leaves_ + a;
    // Down from where the way to the slot before was left, or from the root.
    int level = s == 0 ? levels_ : std::bit_width(a ^ before);
    before = a;
    while (level-- > 0) {
      const std::size_t at = leaf >> level;
      const auto here = static_cast<std::size_t>(level);
      outside_[here] = outside_[here + 1];
      if (at & 1) {
        outside_[here].force = message_[at - 1].force;
        outside_[here].force.noalias() += across_[at - 1].transpose() * outside_[here + 1].force;
      } else {
        outside_[here].motion = message_[at + 1].motion;
        outside_[here].motion.noalias() += across_[at + 1] * outside_[here + 1].motion;
      }
      ++products_;
    }
    Vec6 u = message_[leaf].motion;  // own F
    u.noalias() += chain_->own[a] * outside_[0].force;
    u.noalias() += chain_->transfer[a] * outside_[0].motion;
    products_ += 2;
    for (int k = 0; k < b.dim; ++k, ++h) delta[k] += h->dot(u);
  }
}

void ChainOperator::add_force(std::size_t block, const Real* change) {
  const BlockRows& b = blocks_[block];
  if (b.slots == 0) return;
  const Vec6* h = value_.data() + b.first_value;
  climb_.resize(static_cast<std::size_t>(b.slots));
  for (int s = 0; s < b.slots; ++s) {
    const auto a = static_cast<std::size_t>(place_[b.first_slot + static_cast<std::size_t>(s)]);
    Vec6 f = Vec6::Zero();
    for (int k = 0; k < b.dim; ++k, ++h) f += change[k] * *h;
    force_[a] += f;
    Climb& c = climb_[static_cast<std::size_t>(s)];
    c.at = leaves_ + a;
    c.change.force.noalias() = chain_->transfer[a].transpose() * f;
    c.change.motion.noalias() = chain_->own[a] * f;
    products_ += 2;
  }
  // The root sends to nobody.
  while (true) {
    for (const Climb& c : climb_) {
      message_[c.at].force += c.change.force;
      message_[c.at].motion += c.change.motion;
    }
    if (climb_.front().at <= 3) return;
    std::size_t kept = 0;
    for (const Climb& c : climb_) {
      Climb up{c.at / 2, c.change};
      if (c.at & 1)
        up.change.motion.noalias() = across_[c.at - 1] * c.change.motion;
      else
        up.change.force.noalias() = across_[c.at + 1].transpose() * c.change.force;
      ++products_;
      if (kept > 0 && climb_[kept - 1].at == up.at) {
        climb_[kept - 1].change.force += up.change.force;
        climb_[kept - 1].change.motion += up.change.motion;
      } else {
        climb_[kept++] = up;
      }
    }
    climb_.resize(kept);
  }
}

// --- products of all with all
// -----------------------------------------------------------------------------------

void ChainOperator::combine(std::span<const RowCombination> combinations, bool moves,
                            std::vector<Vec6>& vectors) const {
  vectors.clear();
  for (const RowCombination& c : combinations) {
    const BlockRows& b = blocks_[c.block];
    const Real* factor = moves ? c.move : c.test;
    const Vec6* h = value_.data() + b.first_value;
    for (int s = 0; s < b.slots; ++s) {
      Vec6 sum = Vec6::Zero();
      for (int k = 0; k < b.dim; ++k, ++h) sum += factor[k] * *h;
      vectors.push_back(sum);
    }
  }
}

template <class Add>
void ChainOperator::left_products(std::span<const RowCombination> combinations,
                                  const std::vector<Vec6>& forces, const std::vector<Vec6>& seen,
                                  const Add& add) {
  // Several forces are carried along at once: the transfers are read once for all of them.
  constexpr std::size_t width = Panel::RowsAtCompileTime;
  panel_.resize(force_.size());
  std::size_t slot = 0;
  for (std::size_t first = 0; first < combinations.size(); first += width) {
    const std::size_t count = std::min(width, combinations.size() - first);
    Index top = -1;
    for (std::size_t j = first; j < first + count; ++j) {
      const BlockRows& b = blocks_[combinations[j].block];
      if (b.slots > 0)
        top = std::max(top, place_[b.first_slot + static_cast<std::size_t>(b.slots) - 1]);
    }
    for (Index a = 0; a <= top; ++a) panel_[static_cast<std::size_t>(a)].setZero();
    for (std::size_t j = 0; j < count; ++j) {
      const BlockRows& b = blocks_[combinations[first + j].block];
      for (int s = 0; s < b.slots; ++s, ++slot) {
        const auto a = static_cast<std::size_t>(place_[b.first_slot + static_cast<std::size_t>(s)]);
        panel_[a].row(static_cast<Index>(j)).transpose().noalias() = chain_->own[a] * forces[slot];
      }
    }
    Panel passed = Panel::Zero();
    for (Index i = top; i >= 0; --i) {
      const auto a = static_cast<std::size_t>(i);
      const Panel sum = passed + panel_[a];
      panel_[a] = passed + 0.5 * panel_[a];
      if (i > 0) passed.noalias() = sum * chain_->transfer[a - 1].transpose();
    }
    std::size_t other = 0;
    for (const RowCombination& c : combinations) {
      const BlockRows& b = blocks_[c.block];
      Eigen::Matrix<Real, 4, 1> x = Eigen::Matrix<Real, 4, 1>::Zero();
      for (int s = 0; s < b.slots; ++s, ++other) {
        const Index a = place_[b.first_slot + static_cast<std::size_t>(s)];
        if (a <= top) x.noalias() += panel_[static_cast<std::size_t>(a)] * seen[other];
      }
      for (std::size_t j = 0; j < count; ++j)
        add(c.at, combinations[first + j].at, x[static_cast<Index>(j)]);
    }
  }
}

void ChainOperator::add_products(std::span<const RowCombination> combinations, bool symmetric,
                                 Eigen::Ref<MatX> matrix) {
  // With y(f) = what a force f sends to the left, and half of what it does at its own node,
  //   test W move = test . y(move) + move . y(test),
  // so a symmetric matrix is a matrix plus its transpose, equal to its own transpose to the last
  // bit.
  combine(combinations, true, moved_);
  if (symmetric) {
    left_products(combinations, moved_, moved_, [&](Index i, Index j, Real x) {
      matrix(std::max(i, j), std::min(i, j)) += i == j ? 2 * x : x;
    });
    return;
  }
  combine(combinations, false, seen_);
  left_products(combinations, moved_, seen_, [&](Index i, Index j, Real x) { matrix(i, j) += x; });
  left_products(combinations, seen_, moved_, [&](Index i, Index j, Real x) { matrix(j, i) += x; });
}

void ChainOperator::add_lower_triangle(Eigen::Ref<MatX> W) {
  static const Eigen::Matrix<Real, max_block_dim, max_block_dim> unit = decltype(unit)::Identity();
  rows_.clear();
  for (std::size_t i = 0; i < blocks_.size(); ++i)
    for (int k = 0; k < blocks_[i].dim && blocks_[i].slots > 0; ++k)
      rows_.push_back({i, unit.col(k).data(), unit.col(k).data(), blocks_[i].first_row + k});
  add_products(rows_, true, W);
}

}  // namespace sutura
