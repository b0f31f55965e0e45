#include "rod_history.h"

#include <algorithm>

#include "element_mass.h"
#include "rod_step.h"

namespace sutura::thread {

void RodMoment::resize(Index nodes) {
  const auto n = static_cast<std::size_t>(nodes);
  velocity.clear(6 * nodes);
  tangent_rate.assign(n, Vec3::Zero());
  deformation.resize(n - 1);
}

void RodMoment::reserve(Index nodes) {
  const auto n = static_cast<std::size_t>(nodes);
  velocity.reserve(6 * nodes);
  tangent_rate.reserve(n);
  deformation.reserve(n);
}

void RodMoment::archive(Archive& a) {
  velocity.archive(a, "velocity");
  a.list("tangent_rate", tangent_rate, [](Archive& each, Vec3& rate) { each("rate", rate); });
  a.list("deformation", deformation, [](Archive& each, Deformation& d) {
    each("strain", d.strain);
    each("twist", d.twist);
    each("bend_a", d.bend_a);
    each("bend_b", d.bend_b);
  });
}

void RodMoment::take(const Rod& rod, bool with_deformation) {
  velocity = rod.velocity();
  for (Index i = 0; i < rod.nodes(); ++i)
    tangent_rate[i] = Vec3(velocity.segment<3>(6 * i + 3)).cross(tangent(rod.poses()[i]));
  ElementState s;
  for (Index e = 0; e < rod.beams() && with_deformation; ++e) {
    rod.element_state(e, s);
    deformation[e] = Deformation(s, rod.poses()[e], rod.poses()[e + 1]);
  }
}

void RodMoment::extrapolate(const RodMoment& now, const RodMoment& before, Real share) {
  const auto on = [share](const auto& to, const auto& from) { return to + share * (to - from); };
  velocity = on(now.velocity, before.velocity);
  for (std::size_t i = 0; i < tangent_rate.size(); ++i)
    tangent_rate[i] = on(now.tangent_rate[i], before.tangent_rate[i]);
  for (std::size_t e = 0; e < deformation.size(); ++e) {
    const Deformation &to = now.deformation[e], &from = before.deformation[e];
    deformation[e].strain = on(to.strain, from.strain);
    deformation[e].twist = on(to.twist, from.twist);
    deformation[e].bend_a = on(to.bend_a, from.bend_a);
    deformation[e].bend_b = on(to.bend_b, from.bend_b);
  }
}

void RodMotion::resize(Index nodes) {
  shift_and_tilt.clear(6 * nodes);
  roll.assign(static_cast<std::size_t>(nodes), 0);
}

void RodMotion::reserve(Index nodes) {
  shift_and_tilt.reserve(6 * nodes);
  roll.reserve(static_cast<std::size_t>(nodes));
}

void RodMotion::archive(Archive& a) {
  shift_and_tilt.archive(a, "shift_and_tilt");
  a("roll", roll);
}

void RodMotion::set_zero() {
  shift_and_tilt.setZero();
  std::fill(roll.begin(), roll.end(), 0);
}

void RodMotion::take(const Rod& rod, const Dofs& motion) {
  shift_and_tilt = motion;
  for (Index i = 0; i < rod.nodes(); ++i) {
    const Vec3 about = tangent(rod.poses(Configuration::start)[i]);
    auto turn = shift_and_tilt.segment<3>(6 * i + 3);
    roll[i] = turn.dot(about);
    turn -= roll[i] * about;
  }
}

void RodMotion::scale(const RodMotion& other, Real by) {
  shift_and_tilt = by * other.shift_and_tilt;
  for (std::size_t i = 0; i < roll.size(); ++i) roll[i] = by * other.roll[i];
}

void RodHistory::resize(Index nodes) {
  length = 0;
  start.resize(nodes);
  motion.resize(nodes);
}

void RodHistory::reserve(Index nodes) {
  start.reserve(nodes);
  motion.reserve(nodes);
}

void RodHistory::archive(Archive& a, const Rod& rod) {
  a("length", length);
  if (length == 0) return;
  start.archive(a);
  motion.archive(a);
  const auto nodes = static_cast<std::size_t>(rod.nodes());
  if (start.velocity.size() != rod.dofs() || start.tangent_rate.size() != nodes ||
      start.deformation.size() + 1 != nodes || motion.shift_and_tilt.size() != rod.dofs() ||
      motion.roll.size() != nodes)
    a.fail("the state of another thread");
}

/// Of a step that looks back at the one before.
bool RodStep::goes_on_as_before(const Rod& rod) {
  if (share_ == 0) return true;
  constexpr Real most = 0.5;  // a mode goes on as before from 12 steps a period on
  const DofVector& before = before_.start.velocity;
  const Real w = length_ / before_.length;
  Real largest = 0, off = 0;
  // Squares of changes of velocity in a beam, its spin counted by the energy that it has.
  const auto square = [&](Index e, const DofVector& v) {
    return kinetic(rod.inertia(e), guess_.beams[e], ElementVelocity(v, e)) / rod.element(e).mass;
  };
  change_ = w * (now_.velocity - before);
  answer_ = rod.velocity() - now_.velocity;
  for (Index e = 0; e < rod.beams(); ++e)
    largest = std::max({largest, square(e, change_), square(e, answer_)});
  answer_ -= change_;
  for (Index e = 0; e < rod.beams(); ++e) off = std::max(off, square(e, answer_));
  return off <= most * most * largest;
}

}  // namespace sutura::thread
