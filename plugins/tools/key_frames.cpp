#include "key_frames.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

#include "sutura/units.h"

namespace sutura::tools {
namespace {

/// The rotation vector of `relative` = exp(v) whose angle about its axis is closest to that of
/// `wanted`; the two differ by whole turns.
Vec3 turn_towards(Quat relative, const Vec3& wanted) {
  if (relative.w() < 0) relative.coeffs() = -relative.coeffs();
  const Real sine = relative.vec().norm();
  // Below this the axis is rounding noise; a whole turn then goes about the wanted axis.
  const Vec3 axis = sine > 1e-12 ? Vec3(relative.vec() / sine) : wanted.stableNormalized();
  const Real angle = 2 * std::atan2(sine, relative.w());
  constexpr Real turn = 2 * std::numbers::pi;
  return (angle + turn * std::round((axis.dot(wanted) - angle) / turn)) * axis;
}

Real ease(Real u, Easing easing) {
  return easing == Easing::smooth ? u * u * (3 - 2 * u) : u;
}

}  // namespace

Quat rotation_from_vector(const Vec3& v) {
  const Real angle = v.norm();
  if (angle == 0) return Quat::Identity();
  return Quat(Eigen::AngleAxis<Real>(angle, v / angle));
}

KeyFrames::KeyFrames(std::vector<KeyFrame> keys, const Vec3& centre, Easing easing)
    : keys_(std::move(keys)), centre_(centre), easing_(easing) {
  assert(check(keys_).empty());
  for (const KeyFrame& key : keys_) rotations_.push_back(rotation_from_vector(key.rotation));
  for (std::size_t i = 0; i + 1 < keys_.size(); ++i) {
    turns_.push_back(turn_towards(rotations_[i + 1] * rotations_[i].conjugate(),
                                  keys_[i + 1].rotation - keys_[i].rotation));
  }
}

std::string KeyFrames::check(const std::vector<KeyFrame>& keys) {
  if (keys.empty()) return "no key frame; expected at least one";
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const KeyFrame& key = keys[i];
    if (!std::isfinite(key.time) || !key.position.allFinite() || !key.rotation.allFinite()) {
      return "key " + std::to_string(i + 1) + " is not finite";
    }
    if (i > 0 && !(key.time > keys[i - 1].time)) {
      return "key " + std::to_string(i + 1) + " is at " + format_real(key.time) +
             " s, not after the key before it (" + format_real(keys[i - 1].time) +
             " s); times must increase";
    }
  }
  return {};
}

Pose KeyFrames::at(Real time) const {
  assert(!keys_.empty());
  if (!(time > first_time())) return assemble(keys_.front().position, rotations_.front());
  if (time >= last_time()) return assemble(keys_.back().position, rotations_.back());
  const auto next = std::upper_bound(keys_.begin(), keys_.end(), time,
                                     [](Real t, const KeyFrame& key) { return t < key.time; });
  const auto i = static_cast<std::size_t>(next - keys_.begin()) - 1;
  const Real u = ease((time - keys_[i].time) / (keys_[i + 1].time - keys_[i].time), easing_);
  const Vec3 position = keys_[i].position + u * (keys_[i + 1].position - keys_[i].position);
  return assemble(position, (rotation_from_vector(u * turns_[i]) * rotations_[i]).normalized());
}

Real KeyFrames::largest_turn(Real time) const {
  Real largest = 0;
  for (std::size_t i = 0; i < turns_.size(); ++i) {
    // The ease is symmetric, and fastest about its middle.
    const Real share = std::min(Real(1), time / (keys_[i + 1].time - keys_[i].time));
    const Real part = ease((1 + share) / 2, easing_) - ease((1 - share) / 2, easing_);
    largest = std::max(largest, part * turns_[i].norm());
  }
  return largest;
}

Pose KeyFrames::assemble(const Vec3& position, const Quat& rotation) const {
  return {centre_ + position - rotation * centre_, rotation};
}

}  // namespace sutura::tools
