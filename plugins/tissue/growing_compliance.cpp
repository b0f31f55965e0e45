#include "growing_compliance.h"

#include <algorithm>
#include <utility>

namespace sutura::tissue {
namespace {

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

void GrowingCompliance::begin(const Factor& factor, std::span<const Index> candidates,
                              Index nodes) {
  // Made beside the simulation: what the step learns then rarely takes memory.
  const auto count = static_cast<Index>(candidates.size());
  known_ = 0;
  make_room(count + spare);
  unknowns_.clear();
  unknowns_.reserve(at(3 * (count + spare)));
  for (std::vector<Index>* v : {&missing_, &learnt_.node, &learnt_.end}) {
    v->clear();
    v->reserve(at(spare));
  }
  factor.candidate_compliance(C_);
  known_ = count;
  number_.assign(at(nodes), -1);
  for (const Index i : candidates) {
    number_[at(i)] = static_cast<Index>(unknowns_.size()) / 3;
    for (Index k = 0; k < 3; ++k) unknowns_.push_back(3 * i + k);
  }
  portions_ = 0;
}

/// Half as much again, so that a tissue that is touched more and more rarely has to be copied.
void GrowingCompliance::make_room(Index nodes) {
  if (C_.rows() >= 3 * nodes) return;
  const Index size = 3 * std::min(std::max(nodes, known_ + known_ / 2), std::max(limit, nodes));
  MatX larger(size, size);
  larger.topLeftCorner(3 * known_, 3 * known_) = C_.topLeftCorner(3 * known_, 3 * known_);
  C_.swap(larger);
  entries_.resize(size, 3 * at_once);
}

Index GrowingCompliance::add(std::span<const Index> nodes, const Entries& entries) {
  const Index before = 3 * known_, count = 3 * static_cast<Index>(nodes.size());
  make_room(known_ + static_cast<Index>(nodes.size()));
  for (const Index i : nodes) {
    number_[at(i)] = known_++;
    for (Index k = 0; k < 3; ++k) unknowns_.push_back(3 * i + k);
  }
  entries_.resize(before + count, count);
  entries(unknowns_, std::span(unknowns_).subspan(at(before)), entries_);
  C_.block(0, before, before, count) = entries_.topRows(before);
  C_.block(before, 0, count, before) = entries_.topRows(before).transpose();
  // Symmetric to the last bit, as the compliance of the candidates is.
  for (Index c = 0; c < count; ++c)
    for (Index r = 0; r <= c; ++r)
      C_(before + r, before + c) = C_(before + c, before + r) =
          0.5 * (entries_(before + r, c) + entries_(before + c, r));
  return count;
}

Index GrowingCompliance::learn(std::span<const Index> nodes, std::span<const char> fixed,
                               const Entries& entries) {
  Index solved = 0;
  const auto add_portion = [&] {
    const std::size_t first = portions_ == 0 ? 0 : at(learnt_.end[portions_ - 1]);
    solved +=
        add(std::span(learnt_.node).subspan(first, at(learnt_.end[portions_]) - first), entries);
    ++portions_;
  };
  while (portions_ < learnt_.end.size()) add_portion();
  missing_.clear();
  for (const Index i : nodes)
    if (number_[at(i)] < 0 && !(fixed.size() > at(i) && fixed[at(i)])) {
      number_[at(i)] = limit;  // seen
      missing_.push_back(i);
    }
  for (const Index i : missing_) number_[at(i)] = -1;
  if (known_ + static_cast<Index>(missing_.size()) > limit) return solved;
  for (std::size_t first = 0; first < missing_.size(); first += at(at_once)) {
    const std::size_t count = std::min(at(at_once), missing_.size() - first);
    const auto portion = std::span(missing_).subspan(first, count);
    learnt_.node.insert(learnt_.node.end(), portion.begin(), portion.end());
    learnt_.end.push_back(static_cast<Index>(learnt_.node.size()));
    add_portion();
  }
  return solved;
}

NodeCompliance GrowingCompliance::view(std::span<const Mat3> then,
                                       std::span<const Mat3> now) const {
  if (known_ == 0) return {};
  NodeCompliance out;
  out.see(C_, 3 * known_);
  out.number = number_;
  out.then = then;
  out.now = now;
  return out;
}

void GrowingCompliance::learn_again(LearntNodes learnt) {
  learnt_ = std::move(learnt);
  portions_ = 0;
}

}  // namespace sutura::tissue
