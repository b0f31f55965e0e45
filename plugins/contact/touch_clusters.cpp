#include "touch_clusters.h"

#include <algorithm>
#include <numeric>

namespace sutura::contact {

std::size_t TouchClusters::root(std::size_t i) {
  while (root_[i] != i) i = root_[i] = root_[root_[i]];
  return i;
}

std::size_t TouchClusters::stretch_of(Real place) const {
  const auto it = std::lower_bound(
      stretches_.begin(), stretches_.end(), place,
      [](const std::pair<Real, Real>& stretch, Real at) { return stretch.second < at; });
  return static_cast<std::size_t>(it - stretches_.begin());
}

/// A root is the first of what hangs on it.
void TouchClusters::unite(std::size_t a, std::size_t b) {
  a = root(a), b = root(b);
  root_[std::max(a, b)] = std::min(a, b);
}

void TouchClusters::unite_neighbours(const std::vector<Touch>& touches, Real reach) {
  extents_.assign(stretches_.size(), {});
  const auto extent_of = [this](const Touch& t) -> Extent& {
    return extents_[root(stretch_of(t.first_place))];
  };
  for (const Touch& t : touches) {
    if (!t.carries) continue;
    extent_of(t).sum += t.at;
    ++extent_of(t).touches;
  }
  for (const Touch& t : touches)
    if (t.carries)
      extent_of(t).radius = std::max(extent_of(t).radius, (t.at - extent_of(t).centre()).norm());
  for (std::size_t i = 0; i < stretches_.size(); ++i) {
    if (root_[i] == i) extents_[i].first = stretches_[i].first;
    extents_[root(i)].last = stretches_[i].second;
  }
  for (std::size_t i = 0; i < stretches_.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const Extent &a = extents_[i], &b = extents_[k];
      if (a.touches == 0 || b.touches == 0 || a.first > b.last || b.first > a.last) continue;
      if ((a.centre() - b.centre()).norm() < a.radius + b.radius + reach) unite(i, k);
    }
}

const std::vector<TouchCluster>& TouchClusters::find(const std::vector<Touch>& touches,
                                                     Real reach) {
  places_.clear();
  for (const Touch& t : touches) {
    if (!t.carries) continue;
    places_.push_back(t.first_place);
    places_.push_back(t.second_place);
  }
  std::sort(places_.begin(), places_.end());
  stretches_.clear();
  for (const Real place : places_) {
    if (stretches_.empty() || place - stretches_.back().second > reach)
      stretches_.emplace_back(place, place);
    stretches_.back().second = place;
  }
  root_.resize(stretches_.size());
  std::iota(root_.begin(), root_.end(), std::size_t(0));
  for (const Touch& t : touches)
    if (t.carries) unite(stretch_of(t.first_place), stretch_of(t.second_place));
  unite_neighbours(touches, reach);
  // A root comes before what hangs on it.
  all_.clear();
  by_cluster_.clear();
  by_cluster_.reserve(stretches_.size());  // what a span has begun in stays there
  cluster_.resize(stretches_.size());
  for (std::size_t r = 0; r < stretches_.size(); ++r) {
    if (root(r) != r) continue;
    cluster_[r] = all_.size();
    const std::size_t begin = by_cluster_.size();
    for (std::size_t i = r; i < stretches_.size(); ++i)
      if (root(i) == r) by_cluster_.push_back(stretches_[i]);
    all_.emplace_back().stretches = std::span(by_cluster_).subspan(begin);
  }
  for (const Touch& t : touches) {
    if (!t.carries) continue;
    TouchCluster& c = all_[cluster_[root(stretch_of(t.first_place))]];
    c.fastest = std::max(c.fastest, t.slipped);
    ++c.touches;
  }
  for (TouchCluster& c : all_)
    for (const TouchCluster& other : all_)
      if (other.touches > c.touches && other.first() <= c.last() && c.first() <= other.last())
        c.is_lesser = true;
  return all_;
}

}  // namespace sutura::contact
