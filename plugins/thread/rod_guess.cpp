#include "rod_guess.h"

#include <algorithm>

#include "element_mass.h"

namespace sutura::thread {

void RodStart::resize(Index nodes) {
  RodMoment::resize(nodes);
  load.clear(6 * nodes);
  twist.assign(static_cast<std::size_t>(nodes - 1), 0);
  carried.resize(nodes);
}

void RodStart::reserve(Index nodes) {
  RodMoment::reserve(nodes);
  load.reserve(6 * nodes);
  twist.reserve(static_cast<std::size_t>(nodes));
  carried.reserve(nodes);
}

void ConstraintForce::resize(Index nodes) {
  at.clear(6 * nodes);
  lever.assign(static_cast<std::size_t>(nodes), Vec3::Zero());
  axial_moment.assign(static_cast<std::size_t>(nodes), 0);
}

void ConstraintForce::reserve(Index nodes) {
  at.reserve(6 * nodes);
  lever.reserve(static_cast<std::size_t>(nodes));
  axial_moment.reserve(static_cast<std::size_t>(nodes));
}

Vec3 ConstraintForce::lever_at(Index node, const Pose& section) const {
  return Vec3(at.segment<3>(6 * node + 3)).cross(tangent(section));
}

void ConstraintForce::hold(const Rod& rod) {
  for (Index i = 0; i < rod.nodes(); ++i) {
    lever[i] = lever_at(i, rod.poses()[i]);
    axial_moment[i] = at.segment<3>(6 * i + 3).dot(tangent(rod.poses()[i]));
  }
}

Real ConstraintForce::work(const Rod& rod, Index node, const Dofs& motion) const {
  const Vec3 from = tangent(rod.poses(Configuration::start)[node]);
  return at.segment<3>(6 * node).dot(motion.segment<3>(6 * node)) +
         lever[node].dot(tangent(rod.poses()[node]) - from) +
         axial_moment[node] * motion.segment<3>(6 * node + 3).dot(from);
}

void AtWork::add_moment(const Vec3& moment, const Vec3& tangent) {
  const Real about = moment.dot(tangent);
  bending += (moment - about * tangent).norm();
  roll += std::abs(about);
}

AtWork& AtWork::operator+=(const AtWork& other) {
  force += other.force;
  bending += other.bending;
  roll += other.roll;
  return *this;
}

void RodGuess::resize(Index nodes) {
  const auto n = static_cast<std::size_t>(nodes);
  for (auto* v : {&motion, &missing}) v->clear(6 * nodes);
  force.resize(nodes);
  for (auto* v : {&tension, &limit_tension}) v->assign(n - 1, 0);
  beams.resize(n - 1);
  at_work.assign(n, {});
}

void RodGuess::reserve(Index nodes) {
  const auto n = static_cast<std::size_t>(nodes);
  for (auto* v : {&motion, &missing}) v->reserve(6 * nodes);
  force.reserve(nodes);
  for (auto* v : {&tension, &limit_tension}) v->reserve(n);
  beams.reserve(n);
  at_work.reserve(n);
}

void RodGuess::move(Rod& rod, const RodStart& start) {
  const std::vector<Pose>& from = rod.poses(Configuration::start);
  rod.stretches().follow(from, motion);
  move_chain(from, start.twist, motion, rod.poses(), rod.twist());
  for (Index i = 0; i < rod.nodes(); ++i) {
    const Vec3 turn = motion.segment<3>(6 * i + 3), before = tangent(from[i]);
    const Vec3 now = tangent(rod.poses()[i]);
    const auto carried = start.carried.shift_and_tilt.segment<6>(6 * i);
    rod.velocity().segment<3>(6 * i) = (motion.segment<3>(6 * i) - carried.head<3>()) / start.dt;
    rod.velocity().segment<3>(6 * i + 3) = (turn + turn.dot(before) * (now - before) -
                                            carried.tail<3>() - start.carried.roll[i] * now) /
                                           start.dt;
  }
  evaluate(rod, start);
}

Real RodGuess::roll(const Rod& rod, const NodeSpring& spring) const {
  const Index i = spring.node;
  return spring.roll_at(rod.poses(Configuration::start)[i].rotation, motion.segment<3>(6 * i + 3));
}

bool RodGuess::goes_straight(const Rod& rod, Index node) const {
  const Stretches& stretches = rod.stretches();
  if (stretches.follows(node)) return false;
  for (Index i = node; i < rod.nodes() && stretches.lead(i) == node; ++i)
    if (force.pushes(i) || rod.is_held(i)) return true;
  return false;
}

void RodGuess::take_tension() {
  for (std::size_t e = 0; e < beams.size(); ++e) tension[e] = beams[e].tension;
}

void RodGuess::evaluate(Rod& rod, const RodStart& start) {
  missing.setZero();
  std::fill(at_work.begin(), at_work.end(), AtWork());
  for (Index e = 0; e < rod.beams(); ++e) {
    rod.element_state(e, beams[e]);
    rod.twist()[e] = beams[e].twist;
    add_beam(rod, start, e);
  }
  for (const NodeSpring& spring : rod.springs()) {
    if (!spring.active) continue;
    const Wrench w = wrench(rod, spring);
    missing.segment<3>(6 * spring.node) += start.dt * w.force;
    missing.segment<3>(6 * spring.node + 3) += start.dt * w.moment;
    at_work[spring.node].force += w.force.norm();
    at_work[spring.node].add_moment(w.moment, tangent(rod.poses()[spring.node]));
  }
  missing += start.dt * start.load;
  for (Index i = 0; i < rod.nodes(); ++i) {
    at_work[i].force += start.load.segment<3>(6 * i).norm();
    at_work[i].add_moment(start.load.segment<3>(6 * i + 3), tangent(rod.poses()[i]));
  }
  gather(rod);
  for (const Index node : rod.clamped()) missing.segment<6>(6 * node).setZero();
}

/// What acts on a rigid stretch acts on its leader.
void RodGuess::gather(const Rod& rod) {
  const Stretches& stretches = rod.stretches();
  if (stretches.empty()) return;
  stretches.gather(rod.poses(), missing);
  for (Index i = 0; i < rod.nodes(); ++i) {
    if (!stretches.follows(i)) continue;
    at_work[stretches.lead(i)] += at_work[i];
    at_work[i] = {};
  }
}

void RodGuess::add_beam(const Rod& rod, const RodStart& start, Index e) {
  const Real dt = start.dt;
  const ElementRest& r = rod.element(e);
  const ElementState& s = beams[e];
  const ElementVelocity v(rod.velocity(), e), old(start.velocity, e);
  // What a beam in a rigid stretch bears stays in there.
  const bool is_rigid = rod.stretches().is_rigid(e);
  const ElementGradient g =
      is_rigid ? ElementGradient{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()} : gradient(r, s);
  Vec3 xa = dt * g.v, xb = -xa, sa = -dt * g.a, sb = -dt * g.b;

  // Gravity as a uniform change of velocity is exact and free of rounding; a clamp does not fall.
  Vec3 fall = Vec3::Zero();
  const Vec3 weight = dt * r.mass * start.gravity;
  if (rod.clamped().empty()) {
    fall = dt * start.gravity;
  } else {
    xa += weight / 2;
    xb += weight / 2;
    const Real lever = rod.is_cut(e) ? 0 : r.length / 12;
    sa += lever * s.ta.cross(weight);
    sb -= lever * s.tb.cross(weight);
  }
  if (start.damping.stiffness > 0 && !is_rigid) {
    const Real beta = start.damping.stiffness;
    const ElementGradient d = viscous_gradient(r, s, change_of_deformation(rod, start, *this, e));
    xa += beta * d.v;
    xb -= beta * d.v;
    sa -= beta * d.a;
    sb -= beta * d.b;
  }
  // Change of momentum. The rate of the tangents is compared as a vector: so linear momentum is
  // kept exactly while they turn.
  const Real keep = 1 + dt * start.damping.mass;
  const NodeRates a{keep * v.va - old.va - fall, keep * v.wa.cross(s.ta) - start.tangent_rate[e],
                    keep * v.wa - old.wa};
  const NodeRates b{keep * v.vb - old.vb - fall,
                    keep * v.wb.cross(s.tb) - start.tangent_rate[e + 1], keep * v.wb - old.wb};
  const MassTimes p(rod.inertia(e), s, a, b);
  missing.segment<3>(6 * e) += xa - p.xa;
  missing.segment<3>(6 * e + 3) += sa - p.sa;
  missing.segment<3>(6 * e + 6) += xb - p.xb;
  missing.segment<3>(6 * e + 9) += sb - p.sb;

  const Real inner = g.v.norm() + strain_rounding * r.axial, outer = (weight.norm() / 2) / dt;
  at_work[e].force += inner + p.xa.norm() / dt + outer;
  at_work[e + 1].force += inner + p.xb.norm() / dt + outer;
  at_work[e].add_moment(g.a, s.ta);
  at_work[e].add_moment(p.sa / dt, s.ta);
  at_work[e + 1].add_moment(g.b, s.tb);
  at_work[e + 1].add_moment(p.sb / dt, s.tb);
}

}  // namespace sutura::thread
