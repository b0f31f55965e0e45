// Which triangles of a surface may be near the nodes of another one, or of itself. The lists reach
// further than is asked, and hold until the surfaces have moved by as much.
#pragma once

#include <span>
#include <vector>

#include "surface_mark.h"

namespace sutura::contact {

class NearTriangles {
 public:
  /// All that come within `reach` of a node on the ways of both are listed (m).
  void look(const MovingSurface& nodes, const MovingSurface& faces, Real reach);
  /// Of a node, by its place among `surface_nodes`: ascending; none that it is a corner of.
  std::span<const Index> of(std::size_t place) const {
    return {triangles_.data() + first_[place], first_[place + 1] - first_[place]};
  }

 private:
  void list(const MovingSurface& nodes, const MovingSurface& faces, Real reach);

  SurfaceMark nodes_, faces_;
  Real reach_ = 0;  ///< for which they were made (m)
  std::vector<Index> triangles_;
  std::vector<std::size_t> first_;  ///< by node: of its list; and the end of the last one
};

}  // namespace sutura::contact
