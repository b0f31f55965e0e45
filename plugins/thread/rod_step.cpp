// One step of a rod: guess, balance at the guess, linear answer. The passes are the caller's
// (step.cpp).
#include <algorithm>
#include <cmath>
#include <limits>

#include "rod.h"

namespace sutura::thread {

void Rod::begin_step(Real dt, const Vec3& gravity) {
  dt_ = dt;
  gravity_ = gravity;
  if (!in_step_) {
    start_ = pose_;
    start_twist_ = twist_;
    start_velocity_ = velocity_;
    for (Index i = 0; i < nodes(); ++i)
      start_rate_[i] = Vec3(velocity_.segment<3>(6 * i + 3)).cross(tangent(pose_[i]));
    for (Index e = 0; e < beams() && damping_stiffness > 0; ++e) {
      element_state(e, states_[e]);
      start_deformation_[e] = Deformation(states_[e], pose_[e], pose_[e + 1]);
    }
    in_step_ = true;
  }
  last_turn_ = std::numeric_limits<Real>::infinity();
  stuck_ = false;
  motion_.setZero();
  take_motion();
  for (Index e = 0; e < beams(); ++e) tension_[e] = states_[e].tension;
  // Going on as before is the better guess, unless it turns beams too far for anything to be
  // linear. A rod that nothing holds also falls.
  answer_ = dt * start_velocity_;
  const bool held =
      pushed_ || !clamped_.empty() ||
      std::any_of(springs_.begin(), springs_.end(), [](const NodeSpring& s) { return s.active; });
  for (Index i = 0; i < nodes() && !held; ++i) answer_.segment<3>(6 * i) += dt * dt * gravity;
  if (largest_turn(start_, answer_) > turn_limit) return;
  aim();
  go_on(1);
}

/// states_, missing_ and at_work_ at the guess.
void Rod::evaluate_guess() {
  missing_.setZero();
  std::fill(at_work_.begin(), at_work_.end(), 0);
  for (Index e = 0; e < beams(); ++e) {
    evaluate(elements_[e], pose_[e], pose_[e + 1], twist_[e], states_[e]);
    twist_[e] = states_[e].twist;
    add_beam_balance(e);
  }
  add_spring_balance();
  missing_ += dt_ * load_;
  for (Index i = 0; i < nodes(); ++i) at_work_[i] += load_.segment<3>(6 * i).norm();
  for (const Index node : clamped_) missing_.segment<6>(6 * node).setZero();
}

void Rod::add_beam_balance(Index e) {
  const ElementRest& r = elements_[e];
  const ElementMass& m = masses_[e];
  const ElementState& s = states_[e];
  const ElementVelocity v(velocity_, e), old(start_velocity_, e);
  const ElementGradient g = gradient(r, s);
  Vec3 xa = dt_ * g.v, xb = -xa, sa = -dt_ * g.a, sb = -dt_ * g.b;

  // Gravity as a uniform change of velocity is exact and free of rounding; a clamp does not fall.
  Vec3 fall = Vec3::Zero();
  const Vec3 weight = dt_ * r.mass * gravity_;
  if (clamped_.empty()) {
    fall = dt_ * gravity_;
  } else {
    xa += weight / 2;
    xb += weight / 2;
    sa += r.length / 12 * s.ta.cross(weight);
    sb -= r.length / 12 * s.tb.cross(weight);
  }
  if (damping_stiffness > 0) {
    const ElementGradient d = viscous_gradient(r, s, deformed(e));
    xa += damping_stiffness * d.v;
    xb -= damping_stiffness * d.v;
    sa -= damping_stiffness * d.a;
    sb -= damping_stiffness * d.b;
  }
  // Change of momentum. The rate of the tangents is compared as a vector: so linear momentum is
  // kept exactly while they turn.
  const Real keep = 1 + dt_ * damping_mass;
  const NodeRates a{keep * v.va - old.va - fall, keep * v.wa.cross(s.ta) - start_rate_[e],
                    keep * v.wa - old.wa};
  const NodeRates b{keep * v.vb - old.vb - fall, keep * v.wb.cross(s.tb) - start_rate_[e + 1],
                    keep * v.wb - old.wb};
  const MassTimes p(m, s, a, b);
  missing_.segment<3>(6 * e) += xa - p.xa;
  missing_.segment<3>(6 * e + 3) += sa - p.sa;
  missing_.segment<3>(6 * e + 6) += xb - p.xb;
  missing_.segment<3>(6 * e + 9) += sb - p.sb;

  // A strain of 1e-10 is rounding.
  const Real inner = g.v.norm() + 1e-10 * r.axial, outer = (weight.norm() / 2) / dt_;
  at_work_[e] += inner + g.a.norm() / r.length + p.xa.norm() / dt_ + outer;
  at_work_[e + 1] += inner + g.b.norm() / r.length + p.xb.norm() / dt_ + outer;
}

DeformationChange Rod::deformed(Index e) const {
  return {states_[e], pose_[e], pose_[e + 1], start_deformation_[e]};
}

void Rod::add_spring_balance() {
  for (const NodeSpring& spring : springs_) {
    if (!spring.active) continue;
    const Wrench w = spring_wrench(spring);
    missing_.segment<3>(6 * spring.node) += dt_ * w.force;
    missing_.segment<3>(6 * spring.node + 3) += dt_ * w.moment;
    at_work_[spring.node] += w.force.norm();
  }
}

Wrench Rod::spring_wrench(const NodeSpring& spring) const {
  const Pose& p = pose_[spring.node];
  return {spring.stiffness.translation * (spring.target.position - p.position),
          spring.stiffness.rotation * rotation_between(p.rotation, spring.target.rotation)};
}

namespace {

/// (1 - share) a + share b.
void blend(ElementMatrix& a, const ElementMatrix& b, Real share) {
  const auto mix = [share](Mat3& x, const Mat3& y) { x += share * (y - x); };
  mix(a.vv, b.vv), mix(a.va, b.va), mix(a.vb, b.vb);
  mix(a.aa, b.aa), mix(a.ab, b.ab), mix(a.bb, b.bb);
}

}  // namespace

/// Viscosity is by the convex part of its own stiffness, in both tangents.
void Rod::assemble(Tangent tangent) {
  const Real mass_factor = 1 + dt_ * damping_mass;
  const Real stiffness_factor = dt_ * (dt_ + damping_stiffness);
  matrix_.diagonal(0).setZero();
  ElementMatrix k;
  for (Index e = 0; e < beams(); ++e) {
    const ElementMass& m = masses_[e];
    ElementState& s = states_[e];
    const Real tension = s.tension;
    // Stretch that a turn faked is not to stiffen the beam, unless passes without it get nowhere.
    s.tension = stuck_ && tangent == Tangent::convex ? std::max(tension_[e], tension) : tension_[e];
    if (tangent == Tangent::exact)
      hessian(elements_[e], s, k);
    else
      step_stiffness(elements_[e], s, k);
    if (damping_stiffness > 0) {
      ElementMatrix viscous;
      s.tension -= elements_[e].axial * start_deformation_[e].strain;  // times beta/h
      step_stiffness(elements_[e], s, viscous);
      blend(k, viscous, damping_stiffness / (dt_ + damping_stiffness));
    }
    s.tension = tension;

    Mat6& da = matrix_.diagonal(e);
    Mat6& db = matrix_.diagonal(e + 1);
    Mat6& up = matrix_.upper(e);
    const Mat3 ee = s.e * s.e.transpose();
    const Mat3 vv = stiffness_factor * k.vv;
    const auto plus_diagonal = [](Mat3 a, Real c) {
      a.diagonal().array() += c;
      return a;
    };
    const Real same = mass_factor * m.same, other = mass_factor * m.other;
    const Real cs = mass_factor * m.couple_same, co = mass_factor * m.couple_other;
    const Real ss = mass_factor * m.spin_same, so = mass_factor * m.spin_other;
    const Real rs = mass_factor * m.roll_same, ro = mass_factor * m.roll_other;
    const Mat3 ta = cross_matrix(s.ta), tb = cross_matrix(s.tb);

    da.topLeftCorner<3, 3>() += plus_diagonal(vv, same);
    const Mat3 xs = stiffness_factor * k.va + cs * ta;
    da.topRightCorner<3, 3>() -= xs;
    da.bottomLeftCorner<3, 3>() -= xs.transpose();
    da.bottomRightCorner<3, 3>() +=
        plus_diagonal(stiffness_factor * k.aa + rs * ee - ss * (s.ta * s.ta.transpose()), ss + rs);

    db.topLeftCorner<3, 3>() = plus_diagonal(vv, same);
    const Mat3 ys = stiffness_factor * k.vb + cs * tb;
    db.topRightCorner<3, 3>() = ys;
    db.bottomLeftCorner<3, 3>() = ys.transpose();
    db.bottomRightCorner<3, 3>() =
        plus_diagonal(stiffness_factor * k.bb + rs * ee - ss * (s.tb * s.tb.transpose()), ss + rs);

    up.topLeftCorner<3, 3>() = plus_diagonal(-vv, other);
    up.topRightCorner<3, 3>() = -stiffness_factor * k.vb - co * tb;
    up.bottomLeftCorner<3, 3>() = (stiffness_factor * k.va + co * ta).transpose();
    up.bottomRightCorner<3, 3>() =
        plus_diagonal(stiffness_factor * k.ab + ro * ee - so * (s.tb * s.ta.transpose()),
                      so * s.ta.dot(s.tb) + ro);
  }
  if (tangent == Tangent::exact) add_turning_moments();
  for (const NodeSpring& spring : springs_) {
    if (!spring.active) continue;
    auto diagonal = matrix_.diagonal(spring.node).diagonal().array();
    diagonal.head<3>() += dt_ * dt_ * spring.stiffness.translation;
    diagonal.tail<3>() += dt_ * dt_ * spring.stiffness.rotation;
  }
  for (const Index node : clamped_)
    for (int d = 0; d < 6; ++d) matrix_.fix(node, d);
}

/// A constraint force beside a node has a moment there, t x lever, that turns with the tangent t.
void Rod::add_turning_moments() {
  for (Index i = 0; i < nodes(); ++i) {
    const Vec3 t = tangent(pose_[i]);
    const Mat3 product = t * lever(i).transpose();
    matrix_.diagonal(i).bottomRightCorner<3, 3>() -=
        dt_ * dt_ / 2 * (product + product.transpose());
  }
}

/// Force of constraints times its distance from the node, as far as its moment tells: across the
/// tangent (N m).
Vec3 Rod::lever(Index node) const {
  return Vec3(force_.segment<3>(6 * node + 3)).cross(tangent(pose_[node]));
}

// Rounding can cost a stiff, slender chain its positive definiteness (a free thread's inertia about
// its own axis is 1e-14 of its torsional stiffness): then a shift by so much of the diagonal brings
// it back.
bool Rod::factor() {
  for (Real shift = 1e-13; !matrix_.factor(); shift *= 100) {
    if (!(shift < 1e-6)) return false;
    for (Index i = 0; i < nodes(); ++i) matrix_.diagonal(i).diagonal() *= 1 + shift;
  }
  return true;
}

bool Rod::linearise(const Dofs& force) {
  force_ = force;
  assemble(Tangent::exact);
  if (!matrix_.factor()) {  // something buckles: go downhill
    assemble(Tangent::convex);
    if (!factor()) return false;
  }
  change_ = missing_ + dt_ * force;
  for (const Index node : clamped_) change_.segment<6>(6 * node).setZero();
  matrix_.solve(Eigen::Ref<VecX>(change_));
  return true;
}

namespace {

/// The change of a section's turn (sutura::thread::turned) by which it spins a little further: the
/// inverse of the derivative of its rotation. `from`, `to`: its tangents at the start and now.
Vec3 as_change_of_turn(const Vec3& turn, const Vec3& from, const Vec3& to, const Vec3& spin) {
  const Vec3 tilt = turn - turn.dot(from) * from;
  const Real angle = tilt.norm();
  if (angle < 1e-9) return spin;
  const Vec3 axis = tilt / angle, across = axis.cross(to);
  const Real aside = spin.dot(across);
  return spin.dot(axis) * axis + angle / std::sin(angle) * aside * axis.cross(from) +
         (spin.dot(to) - std::tan(angle / 2) * aside) * from;
}

}  // namespace

void Rod::correct(const Dofs& force_change) {
  force_ += force_change;
  for (Index i = 0; i < nodes(); ++i) {
    lever_[i] = lever(i);
    axial_moment_[i] = force_.segment<3>(6 * i + 3).dot(tangent(pose_[i]));
  }
  answer_ = force_change;
  for (const Index node : clamped_) answer_.segment<6>(6 * node).setZero();
  matrix_.solve(Eigen::Ref<VecX>(answer_));
  change_ += dt_ * answer_;
  answer_ = dt_ * change_;
  const Real turn = largest_turn(pose_, answer_);
  Real part = std::min(1., turn_limit / turn);
  aim();
  predict_tension(part);
  for (Index i = 0; i < nodes(); ++i) {
    Eigen::Ref<Vec3> spin = answer_.segment<3>(6 * i + 3);
    spin = as_change_of_turn(motion_.segment<3>(6 * i + 3), tangent(start_[i]), tangent(pose_[i]),
                             spin);
  }
  // Only what lowers the potential is taken; below a milliradian its changes drown in rounding. But
  // between two places that go straight on, a turn fakes stretch (go_on), which the next pass takes
  // back: there passes may lift the potential as long as they contract.
  const bool contracts = straight_places_ > 1 && turn < 0.5 * last_turn_;
  const bool free = contracts || turn < 1e-3;
  const Real before = free ? 0 : potential();
  go_on(part);
  for (int cut = 0; cut < 12 && !free && !(potential() <= before); ++cut) {
    part /= 2;
    go_on(part);
  }
  stuck_ = !free && part < 0.1;
  last_turn_ = turn;
}

void Rod::guess(const VecX& motion) {
  motion_ = motion;
  take_motion();
}

/// Poses and velocity after the present motion, and the balance there.
void Rod::take_motion() {
  move(start_, start_twist_, motion_, pose_, twist_);
  for (Index i = 0; i < nodes(); ++i) {
    const Vec3 turn = motion_.segment<3>(6 * i + 3), from = tangent(start_[i]);
    velocity_.segment<3>(6 * i) = motion_.segment<3>(6 * i) / dt_;
    velocity_.segment<3>(6 * i + 3) = (turn + turn.dot(from) * (tangent(pose_[i]) - from)) / dt_;
  }
  evaluate_guess();
}

Imbalance Rod::imbalance(const Dofs& force) const {
  Imbalance worst;
  const Real everywhere = *std::max_element(at_work_.begin(), at_work_.end());
  for (Index i = 0; i < nodes(); ++i) {
    if (std::find(clamped_.begin(), clamped_.end(), i) != clamped_.end()) continue;
    const Vec6 r = missing_.segment<6>(6 * i) / dt_ + force.segment<6>(6 * i);
    const Real length = elements_[std::min(i, beams() - 1)].length;
    const Real size = std::max(r.head<3>().norm(), r.tail<3>().norm() / length);
    const Real scale = at_work_[i] + force.segment<3>(6 * i).norm() + negligible * everywhere;
    if (!(size <= worst.force)) worst.force = size;
    const Real relative = scale > 0 ? size / scale : 0;
    if (!(relative <= worst.relative)) worst.relative = relative;
  }
  return worst;
}

void Rod::end_step(const Dofs& force) {
  pushed_ = force.size() > 0 && !force.isZero(0);
  if (pushed_)
    force_ = force;
  else
    force_.setZero();
  for (NodeSpring& spring : springs_)
    if (spring.active) spring.applied = spring_wrench(spring);
  in_step_ = false;
}

Index Rod::advance(Real dt, const Vec3& gravity, const Dofs& force, Real tolerance) {
  constexpr Index most = 100;
  begin_step(dt, gravity);
  Index passes = 0;
  while (passes < most && linearise(force)) {
    answer_.setZero();
    correct(answer_);
    ++passes;
    if (!(imbalance(force).relative > tolerance)) break;
  }
  const bool balanced = imbalance(force).relative <= tolerance;
  end_step(force);
  return balanced ? passes : 0;
}

}  // namespace sutura::thread
