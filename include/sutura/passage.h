// Where a curve goes through a solid in a channel of its own.
#pragma once

#include <vector>

#include "sutura/body.h"

namespace sutura {

/// Something that holds a curve inside a solid. There the two are not in contact; outside of it
/// they are.
class Passage {
 public:
  static constexpr const char* interface_name = "Passage";
  virtual ~Passage() = default;
  virtual const CurveBody& curve() const = 0;
  virtual const SolidBody& solid() const = 0;
  /// Stretches of the curve, in abscissae (m), that are inside at the guess or were so when the
  /// step began.
  struct Stretch {
    Real low = 0, high = 0;
  };
  virtual void inside(std::vector<Stretch>& out) const = 0;
};

}  // namespace sutura
