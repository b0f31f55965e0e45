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
  pose_ = layout.start;
  free_ = layout.start;
  elements_.clear();
  masses_.clear();
  for (std::size_t e = 0; e + 1 < n; ++e) {
    elements_.emplace_back(rest_[e], rest_[e + 1], abscissa_[e + 1] - abscissa_[e], sections_[e]);
    masses_.emplace_back(elements_.back());
  }
  twist_.assign(n - 1, 0);
  free_twist_ = twist_;
  tension_ = twist_;
  for (auto* v : {&velocity_, &free_velocity_, &free_correction_, &last_force_, &rhs_, &scratch_,
                  &before_velocity_, &correction_, &constraint_force_})
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
  for (auto* poses : {&rest_, &pose_, &free_}) poses->reserve(n);
  for (auto* reals : {&twist_, &free_twist_, &tension_}) reals->reserve(n);
  for (auto* v : {&velocity_, &free_velocity_, &free_correction_, &last_force_, &rhs_, &scratch_,
                  &before_velocity_, &correction_, &constraint_force_})
    v->reserve(6 * static_cast<Index>(n));
  matrix_.reserve(static_cast<Index>(n));
  work_.reserve(n);
  work_.clamped.reserve(clamped_.size());
  work_.springs.reserve(springs_.size());
}

void Rod::clamp(Index node) {
  clamped_.push_back(node);
}

void Rod::element_state(Index e, ElementState& s) const {
  evaluate(elements_[e], pose_[e], pose_[e + 1], twist_[e], s);
}

// One pass over the beams: matrix and right-hand side at once. `poses` is where forces are
// evaluated, `v` the velocity there. First pass: poses at the start of the step, forces
// extrapolated by h K v. Later Newton passes: poses = start + h v, and the inertia of v minus the
// old velocity is due.
void Rod::assemble_at(Real dt, const Vec3& gravity, const std::vector<Pose>& poses,
                      std::vector<Real>& twist, const Dofs& v, bool first) {
  if (first) start_energy_ = 0;
  const Real mass_factor = 1 + dt * damping_mass;
  const Real stiffness_factor = dt * (dt + damping_stiffness);
  const Real rate_factor = first ? stiffness_factor : dt * damping_stiffness;
  // Gravity as a uniform change of velocity is exact and free of rounding; a clamp does not fall.
  const bool falls = clamped_.empty();
  const Vec3 fall = falls ? Vec3(dt * gravity) : Vec3::Zero();
  const bool inertia = !first || damping_mass > 0;

  rhs_.setZero();
  matrix_.diagonal(0).setZero();
  ElementState s;
  ElementMatrix k;
  for (Index e = 0; e < beams(); ++e) {
    const ElementRest& r = elements_[e];
    const ElementMass& m = masses_[e];
    evaluate(r, poses[e], poses[e + 1], twist[e], s);
    twist[e] = s.twist;
    const ElementGradient g = gradient(r, s);
    if (!first) s.tension = tension_[e];
    step_stiffness(r, s, k);

    const Vec3 va = v.segment<3>(6 * e), wa = v.segment<3>(6 * e + 3);
    const Vec3 vb = v.segment<3>(6 * e + 6), wb = v.segment<3>(6 * e + 9);
    if (first) start_energy_ += beam_energy(e, s, poses, v, gravity);
    const Vec3 dv = vb - va;
    const Vec3 fv = dt * g.v + rate_factor * (k.vv * dv + k.va * wa + k.vb * wb);
    Vec3 fa = dt * g.a + rate_factor * (k.va.transpose() * dv + k.aa * wa + k.ab * wb);
    Vec3 fb = dt * g.b + rate_factor * (k.vb.transpose() * dv + k.ab.transpose() * wa + k.bb * wb);
    Vec3 xa = fv, xb = -fv;
    if (!falls) {
      const Vec3 weight = dt * r.mass * gravity;
      xa += weight / 2;
      xb += weight / 2;
      fa -= r.length / 12 * s.ta.cross(weight);
      fb += r.length / 12 * s.tb.cross(weight);
    }
    if (inertia) {
      // Momentum due: M (v - v_old) in later passes, and mass damping. The unknown of the first
      // pass leaves out the fall, which is therefore damped too; later ones compare with it.
      const Real c = first ? 0 : 1, d = dt * damping_mass;
      const Vec3 due = (first ? d : -1) * fall;
      const auto rate = [&](Index i) {
        return Vec3(c * (v.segment<3>(i) - velocity_.segment<3>(i)) + d * v.segment<3>(i));
      };
      const MassTimes p(m, s, rate(6 * e) + due, rate(6 * e + 3), rate(6 * e + 6) + due,
                        rate(6 * e + 9));
      xa -= p.xa;
      xb -= p.xb;
      fa += p.sa;
      fb += p.sb;
    }
    rhs_.segment<3>(6 * e) += xa;
    rhs_.segment<3>(6 * e + 3) -= fa;
    rhs_.segment<3>(6 * e + 6) += xb;
    rhs_.segment<3>(6 * e + 9) -= fb;

    // Blocks of A = mass_factor M + stiffness_factor K.
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
  rhs_ += dt * constraint_force_;
  apply_springs(dt, fall, poses, v, first);
  for (const Index node : clamped_) {
    for (int d = 0; d < 6; ++d) matrix_.fix(node, d);
    rhs_.segment<6>(6 * node).setZero();
  }
}

void Rod::apply_springs(Real dt, const Vec3& fall, const std::vector<Pose>& poses, const Dofs& v,
                        bool first) {
  for (const NodeSpring& spring : springs_) {
    if (!spring.active) continue;
    const Index i = 6 * spring.node;
    const Pose& p = poses[spring.node];
    const Real kt = spring.stiffness.translation, kr = spring.stiffness.rotation;
    const Real ahead = first ? dt : 0;
    rhs_.segment<3>(i) += dt * kt *
                          (spring.target.position - p.position - ahead * v.segment<3>(i) -
                           dt * fall * (first ? 1 : 0));
    rhs_.segment<3>(i + 3) +=
        dt * kr *
        (rotation_between(p.rotation, spring.target.rotation) - ahead * v.segment<3>(i + 3));
    auto diagonal = matrix_.diagonal(spring.node).diagonal().array();
    diagonal.head<3>() += dt * dt * kt;
    diagonal.tail<3>() += dt * dt * kr;
  }
}

void Rod::assemble(Real dt, const Vec3& gravity) {
  assemble_at(dt, gravity, pose_, twist_, velocity_, true);
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

void Rod::move(const std::vector<Pose>& from, const std::vector<Real>& twist_from, const Dofs& v,
               Real dt, std::vector<Pose>& to, std::vector<Real>& twist_to) const {
  for (Index e = 0; e < beams(); ++e) {
    const Vec3 span = from[e + 1].position - from[e].position;
    const Vec3 spin = v.segment<3>(6 * e + 9) - v.segment<3>(6 * e + 3);
    twist_to[e] = twist_from[e] + dt * span.dot(spin) / span.norm();
  }
  for (Index i = 0; i < nodes(); ++i) {
    to[i].position = from[i].position + dt * v.segment<3>(6 * i);
    to[i].rotation = rotated(from[i].rotation, dt * v.segment<3>(6 * i + 3));
  }
}

void Rod::advance_free(Real dt, const Vec3& gravity) {
  matrix_.solve(Eigen::Ref<VecX>(rhs_));
  free_velocity_ = velocity_ + rhs_;
  if (clamped_.empty())
    for (Index i = 0; i < nodes(); ++i) free_velocity_.segment<3>(6 * i) += dt * gravity;
  move(pose_, twist_, free_velocity_, dt, free_, free_twist_);
}

/// rhs_ <- A^-1 force.
void Rod::answer(const Dofs& force) {
  rhs_ = force;
  for (const Index node : clamped_) rhs_.segment<6>(6 * node).setZero();
  matrix_.solve(Eigen::Ref<VecX>(rhs_));
}

void Rod::correct(Real dt, const Dofs& force) {
  constraint_force_ = force;
  answer(force);
  velocity_ = free_velocity_ + dt * rhs_;
  // Further than this from the motion that it was linearised about, a linear answer is a fiction
  // that rows feed on.
  scratch_ = dt * (free_correction_ + dt * rhs_);
  excess_turn_ = largest_turn(free_, scratch_) / most_turn;
  if (excess_turn_ > 1) velocity_ += (1 / excess_turn_ - 1) / dt * scratch_;
  move(pose_, twist_, velocity_, dt, pose_, twist_);
  if (keep_ < 1) velocity_ *= keep_;
  for (NodeSpring& spring : springs_) {
    if (!spring.active) continue;
    const Pose& p = pose_[spring.node];
    spring.applied.force = spring.stiffness.translation * (spring.target.position - p.position);
    spring.applied.moment =
        spring.stiffness.rotation * rotation_between(p.rotation, spring.target.rotation);
  }
}

std::size_t Rod::bytes() const {
  const auto n = static_cast<std::size_t>(nodes());
  return n * (matrix_.bytes_per_block() + sizeof(ElementRest) + sizeof(ElementMass) +
              2 * sizeof(Pose) + 3 * sizeof(Real) + 4 * sizeof(Vec6));
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
  a("tension", tension_);
  constraint_force_.archive(a, "constraint_force");
  a.list("guides", guides_, [](Archive& each, Guide& g) {
    each("abscissa", g.abscissa);
    each("point", g.point);
    each("tangent", g.tangent);
    each("acted_at", g.acted_at);
    each("force", g.force);
  });
  a.list("springs", springs_, [](Archive& each, NodeSpring& s) {
    each("node", s.node);
    each("active", s.active);
    each("target", s.target);
    each("translation", s.stiffness.translation);
    each("rotation", s.stiffness.rotation);
    each("applied", s.applied);
  });
  if (pose_.size() != nodes || velocity_.size() != 6 * static_cast<Index>(nodes) ||
      constraint_force_.size() != velocity_.size() || twist_.size() + 1 != nodes ||
      tension_.size() != twist_.size() || springs_.size() != springs)
    a.fail("the state of another thread");
  for (const NodeSpring& s : springs_)
    if (s.node < 0 || s.node >= static_cast<Index>(nodes)) a.fail("a hold of another thread");
  if (!a.restoring()) return;
  free_ = pose_;
  free_twist_ = twist_;
}

}  // namespace sutura::thread
