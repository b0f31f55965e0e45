#include "sutura/types.h"

namespace sutura {

// Here and not in the header: Eigen has a singular value decomposition in it for opposite vectors,
// which takes seconds to compile.
Quat shortest_rotation(const Vec3& from, const Vec3& to) {
  return Quat::FromTwoVectors(from, to);
}

}  // namespace sutura
