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
  /// Do the touches at the corners of a triangle hold what is at `height` over it as well (m)? Held
  /// twice, W would be singular. `was_touched`: it had a touch of its own before.
  bool hold(const std::array<Index, 3>& corners, Real height, bool was_touched) const;

 private:
  Real edge_ = 0;  ///< mean edge of the tissue (m)
  std::vector<Real>
      gap_;  ///< by node of the tissue: between it and the tool; infinite without a touch (m)
  std::vector<char>
      lies_;  ///< by node: a side of the tool lies on a triangle of which it is a corner
};

}  // namespace sutura::contact
