// The free motion of one time step: one linearisation when the motion is calm, more when it is not.
#include <algorithm>
#include <cmath>

#include "element_mass.h"
#include "rod.h"

namespace sutura::thread {

/// Elastic, kinetic and weight energy of one beam.
Real Rod::beam_energy(Index e, const ElementState& s, const std::vector<Pose>& poses, const Dofs& v,
                      const Vec3& gravity) const {
  const ElementRest& r = elements_[e];
  const ElementVelocity w(v, e);
  const Vec3 middle =
      (poses[e].position + poses[e + 1].position) / 2 + r.length / 12 * (s.ta - s.tb);
  return thread::elastic_energy(r, s) + kinetic(masses_[e], s, w) - r.mass * gravity.dot(middle);
}

Real Rod::spring_energy(const std::vector<Pose>& poses) const {
  Real sum = 0;
  for (const NodeSpring& spring : springs_) {
    if (!spring.active) continue;
    const Pose& p = poses[spring.node];
    sum += (spring.stiffness.translation * (spring.target.position - p.position).squaredNorm() +
            spring.stiffness.rotation *
                rotation_between(p.rotation, spring.target.rotation).squaredNorm()) /
           2;
  }
  return sum;
}

Rod::Energy Rod::free_energy(const Vec3& gravity, bool note_tension) {
  Energy sum;
  sum.potential = spring_energy(free_);
  ElementState s;
  for (Index e = 0; e < beams(); ++e) {
    evaluate(elements_[e], free_[e], free_[e + 1], free_twist_[e], s);
    free_twist_[e] = s.twist;
    if (note_tension) tension_[e] = s.tension;
    const Real moving = kinetic(masses_[e], s, ElementVelocity(free_velocity_, e));
    sum.kinetic += moving;
    sum.potential += beam_energy(e, s, free_, free_velocity_, gravity) - moving;
  }
  return sum;
}

/// Tension at the end of the linear step `dv` from `poses`: the linear prediction, which is free of
/// the second-order stretch of a finite rotation.
void Rod::predict_tension(const std::vector<Pose>& poses, const std::vector<Real>& twist,
                          const Dofs& step, Real factor, bool first) {
  ElementState s;
  Vec9 change;
  for (Index e = 0; e < beams(); ++e) {
    evaluate(elements_[e], poses[e], poses[e + 1], twist[e], s);
    change << step.segment<3>(6 * e + 6) - step.segment<3>(6 * e), step.segment<3>(6 * e + 3),
        step.segment<3>(6 * e + 9);
    const Real from = first ? s.tension : tension_[e];
    const Real to = s.tension + elements_[e].axial * strain_gradient(elements_[e], s).dot(change);
    tension_[e] = from + factor * (to - from);
  }
}

/// Adds `part` of the Newton correction in rhs_ to the free motion.
void Rod::add_correction(Real dt, Real part) {
  predict_tension(free_, free_twist_, scratch_, part, false);
  free_velocity_ += part * rhs_;
  move(pose_, twist_, free_velocity_, dt, free_, free_twist_);
}

// A taut thread in its path would leave it by millimetres if its constraints were dropped for the
// free motion, and a linearisation there says nothing about where it will be. So the step is
// linearised about the motion that is expected with constraints: led by guides where a path has
// left some (rod_guides.cpp), else under the constraint forces of the step before. Those are then
// taken off again, linearly: rows still answer with their whole lambda.
bool Rod::free_motion(Real dt, const Vec3& gravity) {
  const bool guided = !guides_.empty() && guided_motion(dt, gravity);
  guides_.clear();
  if (guided) return true;
  if (!expected_motion(dt, gravity)) return false;
  answer(constraint_force_);
  free_correction_ = -dt * rhs_;
  free_velocity_ += free_correction_;
  return true;
}

/// The free motion as the velocity of the step before would have it; tension and start energy are
/// those of now.
void Rod::start_by_inertia(Real dt, const Vec3& gravity) {
  free_ = pose_;
  free_twist_ = twist_;
  free_velocity_ = velocity_;
  start_energy_ = free_energy(gravity, true).total();
  if (clamped_.empty())
    for (Index i = 0; i < nodes(); ++i) free_velocity_.segment<3>(6 * i) += dt * gravity;
  move(pose_, twist_, free_velocity_, dt, free_, free_twist_);
}

/// Linearises where the motion of the step before leads: a turning beam then has no second-order
/// stretch left but that of its acceleration. False if the linear system is not positive definite.
bool Rod::linearise_ahead(Real dt, const Vec3& gravity) {
  start_by_inertia(dt, gravity);
  assemble_at(dt, gravity, free_, free_twist_, free_velocity_, false);
  if (!factor()) return false;
  matrix_.solve(Eigen::Ref<VecX>(rhs_));
  scratch_ = dt * rhs_;
  // A second pass would otherwise meet the tension of the start of the step at the poses of its
  // end.
  if (newton_iterations > 1) predict_tension(free_, free_twist_, scratch_, 1, false);
  free_velocity_ += rhs_;
  move(pose_, twist_, free_velocity_, dt, free_, free_twist_);
  return true;
}

bool Rod::linearise_here(Real dt, const Vec3& gravity) {
  assemble(dt, gravity);
  start_energy_ += spring_energy(pose_);
  if (!factor()) return false;
  advance_free(dt, gravity);
  scratch_ = dt * free_velocity_;
  return true;
}

// One linearisation is all that most steps need. Implicit Euler loses energy; when the linearised
// step gained some (the stretch faked by turning beams, times EA), or turned a beam by more than
// half a radian, Newton goes on until the energy balance holds; if it does not get there, the
// guarded descent does.
bool Rod::expected_motion(Real dt, const Vec3& gravity) {
  keep_ = 1;
  passes_ = 1;
  stuck_ = false;
  scratch_ = dt * velocity_;
  const Real turn = largest_turn(pose_, scratch_);
  const bool ahead = turn > 1e-4 && turn < turn_limit;
  if (!(ahead ? linearise_ahead(dt, gravity) : linearise_here(dt, gravity))) return false;
  Real part = std::min(1., turn_limit / largest_turn(pose_, scratch_));
  const Real slack = 1e-9 * (std::abs(start_energy_) + mass() * gravity.norm() * abscissa_.back());
  const Index most_passes = newton_iterations + 8;
  for (;; ++passes_) {
    if (part == 1 && passes_ >= newton_iterations &&
        free_energy(gravity).total() <=
            start_energy_ + slack + dt * (constraint_force_ + load_).dot(free_velocity_))
      return true;
    if (passes_ >= most_passes) break;
    if (passes_ == 1 && !ahead) {
      predict_tension(pose_, twist_, scratch_, part, true);
      if (part < 1) {
        free_velocity_ *= part;
        move(pose_, twist_, free_velocity_, dt, free_, free_twist_);
      }
    }
    assemble_at(dt, gravity, free_, free_twist_, free_velocity_, false);
    if (!factor()) break;
    matrix_.solve(Eigen::Ref<VecX>(rhs_));
    scratch_ = dt * rhs_;
    part = std::min(1., turn_limit / largest_turn(free_, scratch_));
    add_correction(dt, part);
  }
  return descend(dt, gravity);
}

/// The potential whose minimum is the step of implicit Euler: potential energy plus half the
/// squared difference, in the norm of the mass, to the velocity that inertia alone would keep.
/// Weight is in the potential energy.
Real Rod::incremental_potential(Real dt, const Vec3& gravity) {
  Real sum = spring_energy(free_) + guide_energy() -
             dt * (constraint_force_ + load_).dot(free_velocity_);
  ElementState s;
  scratch_ = free_velocity_ - velocity_;
  for (Index e = 0; e < beams(); ++e) {
    evaluate(elements_[e], free_[e], free_[e + 1], free_twist_[e], s);
    sum += beam_energy(e, s, free_, scratch_, gravity);
  }
  return sum;
}

/// correction_ <- the Newton correction of the free motion, `turn` the largest turn (rad) that it
/// asks of a beam.
bool Rod::find_correction(Real dt, const Vec3& gravity, Real& turn) {
  ++passes_;
  assemble_at(dt, gravity, free_, free_twist_, free_velocity_, false);
  apply_guides(dt);
  if (!factor()) return false;
  matrix_.solve(Eigen::Ref<VecX>(rhs_));
  correction_ = rhs_;
  before_velocity_ = free_velocity_;
  scratch_ = dt * correction_;
  turn = largest_turn(free_, scratch_);
  predict_tension(free_, free_twist_, scratch_, std::min(1., turn_limit / turn), false);
  return true;
}

void Rod::take_correction(Real dt, Real part) {
  free_velocity_ = before_velocity_ + part * correction_;
  move(pose_, twist_, free_velocity_, dt, free_, free_twist_);
}

/// The largest part of the correction, halved from at most `turn_limit`, that lowers the
/// incremental potential; none may. Returns the potential then.
Real Rod::take_shortened(Real dt, const Vec3& gravity, Real turn, Real value) {
  Real part = std::min(1., turn_limit / turn);
  for (int cut = 0; cut < 20; ++cut, part /= 2) {
    take_correction(dt, part);
    const Real next = incremental_potential(dt, gravity);
    if (next < value) return next;
  }
  take_correction(dt, 0);
  return value;
}

// Newton from where the step began, each correction shortened until the incremental potential
// falls. It may stop short of the minimum, which only slows the motion; the velocity carried on is
// then cut to what the energy balance leaves. So no start and no step size makes energy grow.
bool Rod::descend(Real dt, const Vec3& gravity) {
  free_velocity_.setZero();
  free_ = pose_;
  free_twist_ = twist_;
  ElementState s;
  for (Index e = 0; e < beams(); ++e) {
    element_state(e, s);
    tension_[e] = s.tension;
  }
  constexpr int most = 12;
  Real value = incremental_potential(dt, gravity), turn = 0;
  for (int i = 0; i < most; ++i) {
    if (!find_correction(dt, gravity, turn)) return false;
    const Real next = take_shortened(dt, gravity, turn, value);
    if (i == 0)
      stuck_ = !(next < value || turn < 1e-6);  // at rest already if the correction is nothing
    if (value - next < 1e-6 * std::abs(value)) break;
    value = next;
  }
  const Energy end = free_energy(gravity);
  const Real left = start_energy_ + dt * (constraint_force_ + load_).dot(free_velocity_) - end.potential;
  if (end.kinetic > left) keep_ = std::sqrt(std::max(left, 0.) / end.kinetic);
  return true;
}

}  // namespace sutura::thread
