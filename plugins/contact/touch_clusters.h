// Which touches of a thread with itself hang together: the graph whose nodes are stretches of the
// thread with touches close to each other, and whose edges are the touches between them.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "touch.h"

namespace sutura::contact {

struct TouchCluster {
  std::span<const std::pair<Real, Real>> stretches;  ///< first and last place, m; ascending
  Index touches = 0;
  Real fastest = 0;  ///< the largest slip in the step (m)
  /// One with more touches begins or ends between its ends, or it between the ends of that.
  bool is_lesser = false;

  Real first() const { return stretches.front().first; }
  Real last() const { return stretches.back().second; }
};

class TouchClusters {
 public:
  /// Of the touches that carry force. A stretch ends where the next touch along the thread is
  /// further away than `reach` (m). What lies no further from each other than that, one between the
  /// stretches of the other, hangs together as well: throws of one knot need not touch. Ascending
  /// by where they begin.
  const std::vector<TouchCluster>& find(const std::vector<Touch>& touches, Real reach);

 private:
  std::vector<Real> places_;
  std::vector<std::pair<Real, Real>> stretches_, by_cluster_;
  std::vector<std::size_t> root_, cluster_;
  std::vector<TouchCluster> all_;
  /// Of the touches of a root: a ball around them, first and last place on the thread.
  struct Extent {
    Vec3 sum = Vec3::Zero();
    Real touches = 0, radius = 0, first = 0, last = 0;
    Vec3 centre() const { return sum / touches; }
  };
  std::vector<Extent> extents_;
  std::size_t root(std::size_t i);
  void unite(std::size_t a, std::size_t b);
  void unite_neighbours(const std::vector<Touch>& touches, Real reach);
  std::size_t stretch_of(Real place) const;
};

}  // namespace sutura::contact
