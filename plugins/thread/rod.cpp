#include "rod.h"

#include <cassert>
#include <cmath>

#include "element_mass.h"

namespace sutura::thread {

Quat rotated(const Quat& q, const Vec3& spin) {
  const Real a2 = spin.squaredNorm();
  Real c, s;  // cos(a/2), sin(a/2)/a
  if (a2 < 1e-4) {
    c = 1 - a2 / 8 + a2 * a2 / 384;
    s = 0.5 - a2 / 48 + a2 * a2 / 3840;
  } else {
    const Real a = std::sqrt(a2);
    c = std::cos(a / 2);
    s = std::sin(a / 2) / a;
  }
  const Vec3 v = s * spin;
  return (Quat(c, v.x(), v.y(), v.z()) * q).normalized();
}

Quat turned(const Quat& q, const Vec3& turn) {
  const Vec3 along = q * Vec3::UnitX();
  const Real roll = turn.dot(along);
  return rotated(rotated(q, roll * along), turn - roll * along);
}

Vec3 rotation_between(const Quat& from, const Quat& to) {
  Quat d = to * from.conjugate();
  if (d.w() < 0) d.coeffs() = -d.coeffs();
  const Real sine = d.vec().norm();
  if (sine < 1e-9) return 2 * d.vec();
  return d.vec() * (2 * std::atan2(sine, d.w()) / sine);
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
  start_twist_ = tension_ = strain_ = strain_change_ = twist_;
  at_work_.assign(n, 0);
  axial_moment_ = at_work_;
  start_rate_.assign(n, Vec3::Zero());
  lever_ = chord_ = drift_ = start_rate_;
  states_.resize(n - 1);
  start_deformation_.resize(n - 1);
  in_step_ = false;
  for (auto* v : {&velocity_, &load_, &start_velocity_, &motion_, &missing_, &change_, &answer_,
                  &from_, &force_})
    v->clear(dofs());
  clamped_.clear();
  springs_.clear();
  matrix_.resize(nodes());
}

void Rod::reserve(Index beams) {
  const auto n = static_cast<std::size_t>(beams) + 1;
  abscissa_.reserve(n);
  sections_.reserve(n);
  elements_.reserve(n);
  masses_.reserve(n);
  for (auto* poses : {&rest_, &pose_, &start_}) poses->reserve(n);
  for (auto* reals :
       {&twist_, &start_twist_, &tension_, &strain_, &strain_change_, &at_work_, &axial_moment_})
    reals->reserve(n);
  for (auto* vectors : {&start_rate_, &lever_, &chord_, &drift_}) vectors->reserve(n);
  states_.reserve(n);
  start_deformation_.reserve(n);
  for (auto* v : {&velocity_, &load_, &start_velocity_, &motion_, &missing_, &change_, &answer_,
                  &from_, &force_})
    v->reserve(6 * static_cast<Index>(n));
  matrix_.reserve(static_cast<Index>(n));
  work_.reserve(n);
  work_.clamped.reserve(clamped_.size());
  work_.springs.reserve(springs_.size());
}

void Rod::set_load(const VecX& load) {
  load_.clear(dofs());
  if (load.size() == dofs()) load_ = load;
}

void Rod::clamp(Index node) {
  clamped_.push_back(node);
}

void Rod::element_state(Index e, ElementState& s) const {
  evaluate(elements_[e], pose_[e], pose_[e + 1], twist_[e], s);
}

void Rod::move(const std::vector<Pose>& from, const std::vector<Real>& twist_from,
               const Dofs& motion, std::vector<Pose>& to, std::vector<Real>& twist_to) const {
  for (Index e = 0; e < beams(); ++e) {
    const Vec3 span = from[e + 1].position - from[e].position;
    const Vec3 spin = motion.segment<3>(6 * e + 9) - motion.segment<3>(6 * e + 3);
    twist_to[e] = twist_from[e] + span.dot(spin) / span.norm();
  }
  for (Index i = 0; i < nodes(); ++i) {
    to[i].position = from[i].position + motion.segment<3>(6 * i);
    to[i].rotation = turned(from[i].rotation, motion.segment<3>(6 * i + 3));
  }
}

std::size_t Rod::bytes() const {
  const auto n = static_cast<std::size_t>(nodes());
  return n * (matrix_.bytes_per_block() + sizeof(ElementRest) + sizeof(ElementMass) +
              sizeof(ElementState) + 2 * sizeof(Pose) + 4 * sizeof(Real) + 5 * sizeof(Vec6));
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
  velocity_.archive(a, "velocity");
  a("pushed", pushed_);
  force_.archive(a, "force");  // the first guess asks which nodes are pushed
  a.list("springs", springs_, [](Archive& each, NodeSpring& s) {
    each("node", s.node);
    each("active", s.active);
    each("target", s.target);
    each("translation", s.stiffness.translation);
    each("rotation", s.stiffness.rotation);
    each("applied", s.applied);
  });
  if (pose_.size() != nodes || velocity_.size() != dofs() || force_.size() != dofs() ||
      twist_.size() + 1 != nodes || springs_.size() != springs)
    a.fail("the state of another thread");
  for (const NodeSpring& s : springs_)
    if (s.node < 0 || s.node >= static_cast<Index>(nodes)) a.fail("a hold of another thread");
  if (a.restoring()) in_step_ = false;
}

}  // namespace sutura::thread
