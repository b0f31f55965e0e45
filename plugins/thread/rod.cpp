#include "rod.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "element_mass.h"
#include "sutura/geometry/rolling.h"

namespace sutura::thread {

namespace {

/// The shortest turn from one tangent to another (rad).
Vec3 tilt_between(const Vec3& from, const Vec3& to) {
  const Vec3 across = from.cross(to);
  const Real sine = across.norm();
  return sine > 0 ? Vec3(std::atan2(sine, from.dot(to)) / sine * across) : Vec3::Zero();
}

}  // namespace

Real NodeSpring::counted(Real mod_turn) const {
  constexpr Real whole = 2 * std::numbers::pi;
  return mod_turn + whole * std::round((roll - mod_turn) / whole);
}

Real NodeSpring::roll_at(const Quat& start, const Vec3& motion) const {
  const Vec3 along = start * Vec3::UnitX();
  const Real rolled = motion.dot(along);
  const Quat only_tilted = turned(start, motion - rolled * along);
  return counted(roll_between(only_tilted, target.rotation)) - rolled;
}

/// A roll that goes with the shortest turn between tangents a and b changes by a spin about
/// (a + b) / (1 + a.b).
Wrench NodeSpring::wrench(const Pose& section, Real rolled) const {
  Wrench w{stiffness.translation * (target.position - section.position), Vec3::Zero()};
  if (stiffness.rotation == 0) return w;
  const Vec3 a = tangent(section), b = tangent(target);
  w.moment = stiffness.rotation * (tilt_between(a, b) + rolled / (1 + a.dot(b)) * (a + b));
  return w;
}

Real NodeSpring::energy(const Pose& section, Real rolled) const {
  const Real tilted = tilt_between(tangent(section), tangent(target)).squaredNorm();
  return (stiffness.translation * (target.position - section.position).squaredNorm() +
          stiffness.rotation * (tilted + rolled * rolled)) /
         2;
}

Wrench NodeSpring::wrench(const Pose& section) const {
  return wrench(section, counted(roll_between(section.rotation, target.rotation)));
}

void Rod::build(const RodLayout& layout) {
  const std::size_t n = layout.abscissa.size();
  assert(n >= 2 && layout.rest.size() == n && layout.start.size() == n &&
         layout.sections.size() == n - 1);
  abscissa_ = layout.abscissa;
  sections_ = layout.sections;
  rest_ = layout.rest;
  pose_ = start_ = layout.start;
  elements_.clear();
  masses_.clear();
  for (std::size_t e = 0; e + 1 < n; ++e) {
    elements_.emplace_back(rest_[e], rest_[e + 1], abscissa_[e + 1] - abscissa_[e], sections_[e]);
    masses_.emplace_back(elements_.back());
  }
  twist_.assign(n - 1, 0);
  cut_.assign(n - 1, 0);
  for (const Index e : layout.cut) {
    cut_[static_cast<std::size_t>(e)] = 1;
    renew(e);
  }
  velocity_.clear(dofs());
  clamped_.clear();
  springs_.clear();
  stretches_.clear(nodes());
}

void Rod::reserve(Index beams) {
  const auto n = static_cast<std::size_t>(beams) + 1;
  abscissa_.reserve(n);
  sections_.reserve(n);
  elements_.reserve(n);
  masses_.reserve(n);
  for (auto* poses : {&rest_, &pose_, &start_}) poses->reserve(n);
  twist_.reserve(n);
  cut_.reserve(n);
  velocity_.reserve(6 * static_cast<Index>(n));
  stretches_.reserve(static_cast<Index>(n));
}

void Rod::cut(Index beam) {
  const Vec3 before = momentum();
  cut_[static_cast<std::size_t>(beam)] = 1;
  renew(beam);
  // Its mass had moved as its shape did, and now moves with its ends. What that loses of momentum
  // the ends take up, with the halves of beams that go with them.
  Real moved = elements_[static_cast<std::size_t>(beam)].mass;
  if (beam > 0) moved += elements_[static_cast<std::size_t>(beam - 1)].mass / 2;
  if (beam + 1 < beams()) moved += elements_[static_cast<std::size_t>(beam + 1)].mass / 2;
  const Vec3 change = (before - momentum()) / moved;
  for (const Index end : {beam, beam + 1})
    if (!is_clamped(end)) velocity_.segment<3>(6 * end) += change;
}

Index Rod::cuts() const {
  return std::count(cut_.begin(), cut_.end(), 1);
}

void Rod::renew(Index e) {
  const auto i = static_cast<std::size_t>(e);
  ElementRest& r = elements_[i] =
      ElementRest(rest_[i], rest_[i + 1], abscissa_[i + 1] - abscissa_[i], sections_[i]);
  masses_[i] = ElementMass(r);
  if (!is_cut(e)) return;
  r.axial = r.bend_1 = r.bend_2 = r.torsion = 0;
  ElementMass& m = masses_[i];
  m.same = r.mass / 2;
  m.roll_same = r.rotary * r.length / 2;
  m.other = m.couple_same = m.couple_other = m.spin_same = m.spin_other = m.roll_other = 0;
}

bool Rod::is_clamped(Index node) const {
  return std::find(clamped_.begin(), clamped_.end(), node) != clamped_.end();
}

bool Rod::is_held() const {
  return !clamped_.empty() || std::any_of(springs_.begin(), springs_.end(),
                                          [](const NodeSpring& s) { return s.active; });
}

bool Rod::is_held(Index node) const {
  return is_clamped(node) ||
         std::any_of(springs_.begin(), springs_.end(),
                     [node](const NodeSpring& s) { return s.active && s.node == node; });
}

void Rod::element_state(Index e, ElementState& s) const {
  evaluate(elements_[e], pose_[e], pose_[e + 1], twist_[e], s);
}

Real Rod::mass() const {
  Real m = 0;
  for (const ElementRest& r : elements_) m += r.mass;
  return m;
}

Real Rod::elastic_energy() const {
  Real u = 0;
  ElementState s;
  for (Index e = 0; e < beams(); ++e) {
    element_state(e, s);
    u += thread::elastic_energy(elements_[e], s);
  }
  return u;
}

Real Rod::kinetic_energy() const {
  Real t = 0;
  ElementState s;
  for (Index e = 0; e < beams(); ++e) {
    element_state(e, s);
    t += kinetic(masses_[e], s, ElementVelocity(velocity_, e));
  }
  return t;
}

Vec3 Rod::momentum() const {
  Vec3 sum = Vec3::Zero();
  ElementState s;
  for (Index e = 0; e < beams(); ++e) {
    element_state(e, s);
    const ElementVelocity v(velocity_, e);
    const MassTimes p(masses_[e], s, v.va, v.wa, v.vb, v.wb);
    sum += p.xa + p.xb;
  }
  return sum;
}

Vec3 Rod::angular_momentum() const {
  Vec3 sum = Vec3::Zero();
  ElementState s;
  for (Index e = 0; e < beams(); ++e) {
    element_state(e, s);
    const ElementVelocity v(velocity_, e);
    const MassTimes p(masses_[e], s, v.va, v.wa, v.vb, v.wb);
    sum += pose_[e].position.cross(p.xa) + p.sa + pose_[e + 1].position.cross(p.xb) + p.sb;
  }
  return sum;
}

bool Rod::finite() const {
  for (const Pose& p : pose_)
    if (!p.position.allFinite() || !p.rotation.coeffs().allFinite()) return false;
  return velocity_.allFinite();
}

void Rod::archive(Archive& a) {
  const std::size_t nodes = pose_.size(), springs = springs_.size();
  a.list("poses", pose_, [](Archive& each, Pose& pose) { each("pose", pose); });
  a("twist", twist_);
  a("cut", cut_);
  velocity_.archive(a, "velocity");
  a.list("springs", springs_, [](Archive& each, NodeSpring& s) {
    each("node", s.node);
    each("active", s.active);
    each("last_target", s.last_target);
    each("target", s.target);
    each("translation", s.stiffness.translation);
    each("rotation", s.stiffness.rotation);
    each("roll", s.roll);
    each("applied", s.applied);
  });
  if (pose_.size() != nodes || velocity_.size() != dofs() || twist_.size() + 1 != nodes ||
      cut_.size() + 1 != nodes || springs_.size() != springs)
    a.fail("the state of another thread");
  else
    stretches_.archive(a);
  if (a.restoring() && a.ok())
    for (Index e = 0; e < beams(); ++e) renew(e);
  for (const NodeSpring& s : springs_)
    if (s.node < 0 || s.node >= static_cast<Index>(nodes)) a.fail("a hold of another thread");
}

}  // namespace sutura::thread
