// A point that moves with a body and that others may ask for: what probes offer to each other.
#pragma once

#include "sutura/types.h"

namespace sutura {

class PointProbe {
 public:
  static constexpr const char* interface_name = "PointProbe";
  virtual ~PointProbe() = default;
  virtual Vec3 position() const = 0;  ///< m, at the end of the last step
};

}  // namespace sutura
