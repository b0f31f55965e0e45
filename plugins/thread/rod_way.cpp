// The way from one guess of a rod's step to the next.
#include <algorithm>

#include "rod.h"

namespace sutura::thread {

/// Where the beams are at the guess, and how their strain is to change by the answer.
void Rod::aim() {
  from_ = motion_;
  straight_places_ = 0;
  for (Index i = 0; i < nodes(); ++i) straight_places_ += goes_straight(i);
  Vec9 change;
  for (Index e = 0; e < beams(); ++e) {
    const ElementState& s = states_[e];
    change << answer_.segment<3>(6 * e + 6) - answer_.segment<3>(6 * e),
        answer_.segment<3>(6 * e + 3), answer_.segment<3>(6 * e + 9);
    chord_[e] = s.l * s.e;
    strain_[e] = s.strain;
    strain_change_[e] = strain_gradient(elements_[e], s).dot(change);
  }
}

/// Tension after `part` of the answer: the linear prediction, which is free of the stretch that a
/// finite turn fakes.
void Rod::predict_tension(Real part) {
  for (Index e = 0; e < beams(); ++e) {
    const Real to = elements_[e].axial * (strain_[e] + strain_change_[e]);
    tension_[e] += part * (to - tension_[e]);
  }
}

/// The guess goes on by a part of the answer. Straight on, a beam that turns or bends would be
/// stretched in second order, and that times EA hides everything else. So chords turn, and get the
/// length at which the beam has the strain that the answer says. Where the rod is held or pushed it
/// goes straight on; what does not fit between two such places is shared out.
void Rod::go_on(Real part) {
  motion_ = from_ + part * answer_;
  Vec3 drift = Vec3::Zero();      // of the beams joined one to another
  Vec3 at_anchor = Vec3::Zero();  // that of the last node that goes straight on
  Index anchor = -1;
  Pose a, b;  // of a beam, in axes of its own first node
  a.position.setZero();
  ElementState s;
  for (Index i = 0; i < nodes(); ++i) {
    b.rotation = turned(start_[i].rotation, motion_.segment<3>(6 * i + 3));
    if (i > 0) {
      const Index e = i - 1;
      const Vec3& chord = chord_[e];
      const Vec3 change = part * (answer_.segment<3>(6 * i) - answer_.segment<3>(6 * e));
      const Vec3 turn = chord.cross(change) / chord.squaredNorm();
      b.position = rotated(Quat::Identity(), turn) * chord;
      evaluate(elements_[e], a, b, twist_[e], s);
      const Real due = strain_[e] + part * strain_change_[e];
      b.position *= 1 + (due - s.strain) * elements_[e].length / s.l;
      drift += b.position - chord - change;
    }
    drift_[i] = drift;
    a.rotation = b.rotation;
    if (!goes_straight(i)) continue;
    const Vec3 misfit = anchor < 0 ? Vec3::Zero() : Vec3(drift - at_anchor);
    const Vec3 begin = anchor < 0 ? drift : at_anchor;
    const Real length = anchor < 0 ? 1 : abscissa_[i] - abscissa_[anchor];
    for (Index k = anchor + 1; k <= i; ++k) {
      const Real way = anchor < 0 ? 0 : (abscissa_[k] - abscissa_[anchor]) / length;
      drift_[k] -= begin + way * misfit;
    }
    at_anchor = drift;
    anchor = i;
  }
  for (Index k = anchor + 1; k < nodes(); ++k) drift_[k] -= at_anchor;
  for (Index i = 0; i < nodes(); ++i) motion_.segment<3>(6 * i) += drift_[i];
  take_motion();
  if (anchor >= 0) return;
  // Free, its linear momentum is exact: a shift of the whole takes up what the drifts left of it.
  Vec3 missing = Vec3::Zero();
  for (Index i = 0; i < nodes(); ++i) missing += missing_.segment<3>(6 * i);
  const Vec3 shift = dt_ * missing / (mass() * (1 + dt_ * damping_mass));
  for (Index i = 0; i < nodes(); ++i) motion_.segment<3>(6 * i) += shift;
  take_motion();
}

/// A node that is held, or that constraints push.
bool Rod::goes_straight(Index node) const {
  return !force_.segment<3>(6 * node).isZero(0) ||
         std::any_of(springs_.begin(), springs_.end(),
                     [node](const NodeSpring& s) { return s.active && s.node == node; }) ||
         std::find(clamped_.begin(), clamped_.end(), node) != clamped_.end();
}

}  // namespace sutura::thread
