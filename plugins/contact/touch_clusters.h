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
  Real fastest = 0;                                  ///< the largest slip in the step (m)

  Real first() const { return stretches.front().first; }
  Real last() const { return stretches.back().second; }
};

class TouchClusters {
 public:
  /// Of the touches that carry force. A stretch ends where the next touch along the thread is
  /// further away than `reach` (m). Ascending by where they begin.
  const std::vector<TouchCluster>& find(const std::vector<Touch>& touches, Real reach);

 private:
  std::vector<Real> places_;
  std::vector<std::pair<Real, Real>> stretches_, by_cluster_;
  std::vector<std::size_t> root_, cluster_;
  std::vector<TouchCluster> all_;
  std::size_t root(std::size_t i);
  std::size_t stretch_of(Real place) const;
};

}  // namespace sutura::contact
