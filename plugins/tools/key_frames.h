// Key frames: a rigid motion of space over time, given at a few instants.
//
//   x(t) = centre + R(t) (x - centre) + p(t)
//
// so that a pure rotation key about the centre of a needle's arc moves the needle along that arc.
#pragma once

#include <string>
#include <vector>

#include "sutura/types.h"

namespace sutura::tools {

/// One instant of the motion.
struct KeyFrame {
  Real time = 0;                 ///< s
  Vec3 position = Vec3::Zero();  ///< translation p (m)
  Vec3 rotation = Vec3::Zero();  ///< axis times angle of R (rad); may exceed a turn
};

/// How the time between two keys is spent; positions and rotations share it, so that a key with
/// both stays on one path.
enum class Easing {
  linear,  ///< constant speed, jumps of velocity at the keys: for recorded motion
  smooth,  ///< 3 u^2 - 2 u^3: rests at every key, for a few keys written by hand
};

class KeyFrames {
 public:
  KeyFrames() = default;
  /// Requires check(keys) to be empty.
  KeyFrames(std::vector<KeyFrame> keys, const Vec3& centre, Easing easing);

  /// What is wrong with the keys, in a sentence (none, not finite, times not increasing), or empty.
  static std::string check(const std::vector<KeyFrame>& keys);

  /// The motion as a pose: x(t) = at(t).position + at(t).rotation * x. Rests before the first key
  /// and after the last. Between two keys the rotation turns about one axis at the pace of the
  /// easing (slerp), through the angle that is closest to the difference of the two rotation
  /// vectors: keys that share an axis may be more than half a turn apart.
  Pose at(Real time) const;

  /// The largest angle by which it turns within such a time, between two keys (rad).
  Real largest_turn(Real time) const;

  Real first_time() const { return keys_.front().time; }
  Real last_time() const { return keys_.back().time; }

 private:
  Pose assemble(const Vec3& position, const Quat& rotation) const;

  std::vector<KeyFrame> keys_;
  std::vector<Quat> rotations_;  ///< of the keys
  std::vector<Vec3> turns_;      ///< from key i to key i+1, in scene axes
  Vec3 centre_ = Vec3::Zero();
  Easing easing_ = Easing::linear;
};

/// Rotation by |v| about v.
Quat rotation_from_vector(const Vec3& v);

}  // namespace sutura::tools
