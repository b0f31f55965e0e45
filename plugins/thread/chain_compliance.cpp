#include "chain_compliance.h"

#include <algorithm>

namespace sutura::thread {

void ChainCompliance::add(const BlockTridiagonal& A, const std::vector<Index>& clamped,
                          const BodyRows& rows, Real dt, Eigen::Ref<MatX> W) {
  std::vector<Index>& node = chain_.node;
  node = rows.node;
  std::sort(node.begin(), node.end());
  node.erase(std::unique(node.begin(), node.end()), node.end());
  std::erase_if(node, [&clamped](Index n) {
    return std::find(clamped.begin(), clamped.end(), n) != clamped.end();
  });
  A.condense(node, chain_.own, chain_.transfer);
  for (Mat6& own : chain_.own) own *= dt * dt;
  add(chain_, rows, W);
}

void ChainCompliance::read(const CondensedChain& chain, const BodyRows& rows) {
  entry_.clear();
  first_entry_.assign(1, 0);
  for (std::size_t r = 0; r < rows.row.size(); ++r) {
    for (auto e = static_cast<std::size_t>(rows.start[r]);
         e < static_cast<std::size_t>(rows.start[r + 1]); ++e) {
      const auto found = std::lower_bound(chain.node.begin(), chain.node.end(), rows.node[e]);
      if (found == chain.node.end() || *found != rows.node[e]) continue;  // cannot move
      entry_.push_back({static_cast<std::size_t>(found - chain.node.begin()),
                        Eigen::Map<const Vec6>(&rows.value[6 * e])});
    }
    std::sort(entry_.begin() + static_cast<std::ptrdiff_t>(first_entry_.back()), entry_.end(),
              [](const Entry& a, const Entry& b) { return a.place < b.place; });
    first_entry_.push_back(entry_.size());
  }
}

// Every force is carried from its last node to the first. With y(h) = what a force h sends to the
// left, and half of what it does at its own nodes,
//   h_i^T G h_j = h_i . y(h_j) + h_j . y(h_i),
// so the matrix is equal to its transpose to the last bit.
void ChainCompliance::add(const CondensedChain& chain, const BodyRows& rows, Eigen::Ref<MatX> W) {
  read(chain, rows);
  const auto count = static_cast<std::size_t>(rows.size());
  own_W_.setZero(rows.size(), rows.size());
  panel_.resize(chain.node.size());
  // Several forces are carried along at once: the transfers are read once for all of them.
  constexpr std::size_t width = Panel::RowsAtCompileTime;
  for (std::size_t first = 0; first < count; first += width) {
    const std::size_t last = std::min(first + width, count);
    std::size_t places = 0;  // up to the last one with a force
    for (std::size_t j = first; j < last; ++j)
      if (first_entry_[j + 1] > first_entry_[j])
        places = std::max(places, entry_[first_entry_[j + 1] - 1].place + 1);
    for (std::size_t a = 0; a < places; ++a) panel_[a].setZero();
    for (std::size_t j = first; j < last; ++j)
      for (std::size_t e = first_entry_[j]; e < first_entry_[j + 1]; ++e)
        panel_[entry_[e].place].row(static_cast<Index>(j - first)).transpose().noalias() +=
            chain.own[entry_[e].place] * entry_[e].value;
    Panel passed = Panel::Zero();
    for (std::size_t a = places; a-- > 0;) {
      const Panel sum = passed + panel_[a];
      panel_[a] = passed + 0.5 * panel_[a];
      if (a > 0) passed.noalias() = sum * chain.transfer[a - 1].transpose();
    }
    for (std::size_t i = 0; i < count; ++i) {
      Eigen::Matrix<Real, 4, 1> seen = Eigen::Matrix<Real, 4, 1>::Zero();
      for (std::size_t e = first_entry_[i]; e < first_entry_[i + 1]; ++e)
        if (entry_[e].place < places) seen.noalias() += panel_[entry_[e].place] * entry_[e].value;
      for (std::size_t j = first; j < last; ++j)
        own_W_(static_cast<Index>(std::max(i, j)), static_cast<Index>(std::min(i, j))) +=
            (i == j ? 2 : 1) * seen[static_cast<Index>(j - first)];
    }
  }
  for (Index j = 0; j < rows.size(); ++j)
    for (Index i = j; i < rows.size(); ++i) {
      const Index a = rows.row[static_cast<std::size_t>(i)],
                  b = rows.row[static_cast<std::size_t>(j)];
      const Real w = own_W_(i, j);
      W(a, b) += w;
      if (a != b) W(b, a) += w;
    }
}

}  // namespace sutura::thread
