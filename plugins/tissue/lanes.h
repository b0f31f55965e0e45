// Four numbers that go through the same arithmetic at once: one AVX register.
#pragma once

#include "sutura/types.h"

namespace sutura::tissue {

inline constexpr int lanes = 4;
using Lanes = Real __attribute__((vector_size(lanes * sizeof(Real))));
using LaneMask = decltype(Lanes{} < Lanes{});

inline bool any_lane(const LaneMask& m) {
  return (m[0] | m[1] | m[2] | m[3]) != 0;
}
inline bool any_lane(bool m) {
  return m;
}
inline Lanes choose(const LaneMask& m, const Lanes& a, const Lanes& b) {
  return m ? a : b;
}
inline Real choose(bool m, Real a, Real b) {
  return m ? a : b;
}

}  // namespace sutura::tissue
