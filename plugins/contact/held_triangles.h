// Where a tool presses the nodes of a tissue: which of its own nodes need no touch of their own
// there.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "moving_surface.h"
#include "touch.h"

namespace sutura::contact {

class HeldTriangles {
 public:
  /// `touches`: those that nodes of the tissue have with the tool, at the guess.
  void look(const MovingSurface& tissue, std::span<const Touch> touches);
  /// Do the touches at the corners of a triangle hold a node of the tool at `height` over it too
  /// (m)? Held twice, W would be singular. `was_touched`: the node had a touch of its own before.
  bool hold(const std::array<Index, 3>& corners, Real height, bool was_touched) const;

 private:
  Real edge_ = 0;           ///< mean edge of the tissue (m)
  std::vector<Real> gap_;   ///< by node: of its touch; infinite without one (m)
  std::vector<char> lies_;  ///< by node: all three corners of a triangle around it are pressed
};

}  // namespace sutura::contact
