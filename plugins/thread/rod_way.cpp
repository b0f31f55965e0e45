#include "rod_way.h"

namespace sutura::thread {

Real largest_turn(const Rod& rod, Configuration c, const Dofs& motion) {
  const std::vector<Pose>& poses = rod.poses(c);
  Real largest = 0;
  for (Index i = 0; i < rod.nodes(); ++i) {
    const auto spin = motion.segment<3>(6 * i + 3);
    largest = std::max(largest, tangent(poses[i]).cross(spin).norm());
    if (i == 0 || rod.is_cut(i - 1)) continue;
    const Vec3 chord = poses[i].position - poses[i - 1].position;
    const Vec3 change = motion.segment<3>(6 * i) - motion.segment<3>(6 * i - 6);
    largest = std::max(largest, chord.cross(change).norm() / chord.squaredNorm());
  }
  return largest;
}

void RodWay::resize(Index nodes) {
  const auto n = static_cast<std::size_t>(nodes);
  for (auto* v : {&from_, &direction_}) v->clear(6 * nodes);
  for (auto* reals : {&strain_, &strain_change_}) reals->assign(n - 1, 0);
  give_.assign(n, 0);
  for (auto* vectors : {&chord_, &drift_}) vectors->assign(n, Vec3::Zero());
}

void RodWay::reserve(Index nodes) {
  const auto n = static_cast<std::size_t>(nodes);
  for (auto* v : {&from_, &direction_}) v->reserve(6 * nodes);
  for (auto* reals : {&strain_, &strain_change_, &give_}) reals->reserve(n);
  for (auto* vectors : {&chord_, &drift_}) vectors->reserve(n);
}

void RodWay::aim(const Rod& rod, const RodGuess& guess, const Dofs& answer) {
  from_ = guess.motion;
  direction_ = answer;
  const std::vector<Pose>& begin = rod.poses(Configuration::start);
  for (Index i = 0; i < rod.nodes(); ++i) {
    direction_.segment<3>(6 * i + 3) =
        as_change_of_turn(guess.motion.segment<3>(6 * i + 3), tangent(begin[i]),
                          tangent(rod.poses()[i]), answer.segment<3>(6 * i + 3));
  }
  for (Index e = 0; e < rod.beams(); ++e) {
    const ElementState& s = guess.beams[e];
    chord_[e] = s.l * s.e;
    // The gap of a cut takes up whatever does not fit.
    const Real axial =
        rod.is_cut(e) ? 1e-9 * rod.section(e).axial_stiffness() : rod.element(e).axial;
    give_[e + 1] = give_[e] + (rod.stretches().is_rigid(e) ? 0 : rod.element(e).length / axial);
    strain_[e] = s.strain;
    strain_change_[e] = strain_gradient(rod.element(e), s).dot(beam_motion(answer, e));
  }
}

void RodWay::predict_tension(const Rod& rod, RodGuess& guess, Real part) const {
  for (Index e = 0; e < rod.beams(); ++e) {
    const Real to = rod.element(e).axial * (strain_[e] + strain_change_[e]);
    guess.tension[e] += part * (to - guess.tension[e]);
  }
}

void RodWay::go(Rod& rod, const RodStart& start, RodGuess& guess, Real part) {
  guess.motion = from_ + part * direction_;
  join(rod, guess, part);
  const bool anchored = share_out_drift(rod, guess);
  for (Index i = 0; i < rod.nodes(); ++i) guess.motion.segment<3>(6 * i) += drift_[i];
  guess.move(rod, start);
  if (!anchored) keep_momentum(rod, start, guess);
}

/// Joins the beams one to another, turned and stretched as they are after `part` of the way:
/// `drift_` is how far that leads every node off the straight way, from the first one on.
void RodWay::join(const Rod& rod, const RodGuess& guess, Real part) {
  const std::vector<Pose>& begin = rod.poses(Configuration::start);
  const Stretches& stretches = rod.stretches();
  Quat stretch_turn = Quat::Identity();  // of the rigid stretch that node i is in, since the start
  Vec3 drift = Vec3::Zero();
  Quat before;
  for (Index i = 0; i < rod.nodes(); ++i) {
    Quat rotation;
    if (stretches.follows(i)) {
      rotation = stretch_turn * begin[i].rotation;
    } else {
      rotation = turned(begin[i].rotation, guess.motion.segment<3>(6 * i + 3));
      stretch_turn = rotation * begin[i].rotation.conjugate();
    }
    if (i > 0) {
      const Index e = i - 1;
      const Vec3 change = part * (direction_.segment<3>(6 * i) - direction_.segment<3>(6 * e));
      Vec3 chord = chord_[e] + change;  // across a cut
      if (stretches.is_rigid(e))
        chord = stretch_turn * (begin[i].position - begin[e].position);
      else if (!rod.is_cut(e))
        chord = turned_chord(rod, e, before, rotation, change, part);
      drift += chord - chord_[e] - change;
    }
    drift_[i] = drift;
    before = rotation;
  }
}

/// Chord of a beam whose ends have turned so and move apart by `change`: turned as they move, and
/// as long as the strain of the linear answer asks.
Vec3 RodWay::turned_chord(const Rod& rod, Index e, const Quat& first, const Quat& second,
                          const Vec3& change, Real part) const {
  const Vec3 turn = chord_[e].cross(change) / chord_[e].squaredNorm();
  const Vec3 chord = rotated(Quat::Identity(), turn) * chord_[e];
  ElementState s;
  evaluate(rod.element(e), {Vec3::Zero(), first}, {chord, second}, rod.twist()[e], s);
  const Real due = strain_[e] + part * strain_change_[e];
  return chord * (1 + (due - s.strain) * rod.element(e).length / s.l);
}

/// Where a node goes straight on, no drift is left; between two such nodes it is shared out as the
/// beams give way. False if no node does, and all drift as they are joined.
bool RodWay::share_out_drift(const Rod& rod, const RodGuess& guess) {
  Vec3 at_anchor = Vec3::Zero();  // drift of the last node that goes straight on
  Index anchor = -1;
  for (Index i = 0; i < rod.nodes(); ++i) {
    if (!guess.goes_straight(rod, i)) continue;
    const Vec3 drift = drift_[i];
    const Vec3 misfit = anchor < 0 ? Vec3::Zero() : Vec3(drift - at_anchor);
    const Vec3 first = anchor < 0 ? drift : at_anchor;
    const Real between = anchor < 0 ? 1 : give_[i] - give_[anchor];
    for (Index k = anchor + 1; k <= i; ++k) {
      const Real way = anchor < 0 ? 0 : (give_[k] - give_[anchor]) / between;
      drift_[k] -= first + way * misfit;
    }
    at_anchor = drift;
    anchor = i;
  }
  for (Index k = anchor + 1; k < rod.nodes(); ++k) drift_[k] -= at_anchor;
  return anchor >= 0;
}

/// The linear momentum of a free rod is exact: a shift of the whole takes up what the drifts left
/// of it.
void RodWay::keep_momentum(Rod& rod, const RodStart& start, RodGuess& guess) const {
  Vec3 missing = Vec3::Zero();
  for (Index i = 0; i < rod.nodes(); ++i) missing += guess.missing.segment<3>(6 * i);
  const Vec3 shift = start.dt * missing / (rod.mass() * (1 + start.dt * start.damping.mass));
  for (Index i = 0; i < rod.nodes(); ++i) guess.motion.segment<3>(6 * i) += shift;
  guess.move(rod, start);
}

}  // namespace sutura::thread
