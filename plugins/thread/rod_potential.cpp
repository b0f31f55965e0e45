// The potential of a rod's step (incremental potential of implicit Euler): a step ends where it has
// a minimum. Its value, and what to do where a guess is balanced but at a saddle.
#include <algorithm>
#include <cmath>
#include <limits>

#include "rod.h"

namespace sutura::thread {

/// Elastic energy and weight, springs, what drag and viscosity take, half the squared change of
/// velocity in the norm of the mass, less the work of loads and of the constraints of the last
/// pass.
Real Rod::potential() const {
  Real sum = 0;
  for (Index e = 0; e < beams(); ++e) {
    const ElementState& s = states_[e];
    const ElementVelocity v(velocity_, e), old(start_velocity_, e);
    if (damping_stiffness > 0)
      sum += damping_stiffness / dt_ * viscous_energy(elements_[e], deformed(e));
    sum += dt_ * damping_mass * kinetic(masses_[e], s, v);
    // Weight as in add_beam_balance.
    const bool falls = clamped_.empty();
    const Vec3 fall = falls ? Vec3(dt_ * gravity_) : Vec3::Zero();
    const NodeRates a{v.va - old.va - fall, v.wa.cross(s.ta) - start_rate_[e], v.wa - old.wa};
    const NodeRates b{v.vb - old.vb - fall, v.wb.cross(s.tb) - start_rate_[e + 1], v.wb - old.wb};
    sum += thread::elastic_energy(elements_[e], s) + MassTimes(masses_[e], s, a, b).squared / 2;
    const ElementRest& r = elements_[e];
    if (!falls)
      sum -= r.mass * gravity_.dot(dt_ / 2 * (v.va + v.vb) + r.length / 12 * (s.ta - s.tb));
  }
  for (const NodeSpring& spring : springs_) {
    if (!spring.active) continue;
    const Wrench w = spring_wrench(spring);
    sum += w.force.squaredNorm() / (2 * spring.stiffness.translation);
    if (spring.stiffness.rotation > 0)
      sum += w.moment.squaredNorm() / (2 * spring.stiffness.rotation);
  }
  sum -= load_.dot(motion_);
  for (Index i = 0; i < nodes(); ++i)
    sum -= force_.segment<3>(6 * i).dot(motion_.segment<3>(6 * i)) +
           lever_[i].dot(tangent(pose_[i]) - tangent(start_[i])) +
           axial_moment_[i] * motion_.segment<3>(6 * i + 3).dot(tangent(start_[i]));
  return sum;
}

/// Whether the guess is no minimum of the potential, as a straight rod is not that is pushed
/// together. Overwrites the matrix of the step, which the next pass assembles anew.
bool Rod::buckles() {
  bool compressed = false;
  for (Index e = 0; e < beams() && !compressed; ++e) {
    // A straight beam that inertia alone holds sideways buckles at 2 sqrt(EI m / L) / h.
    const Real least = std::sqrt(elements_[e].bend_1 * elements_[e].mass) / dt_;
    compressed = states_[e].tension < -least;
  }
  if (!compressed) return false;
  for (Index e = 0; e < beams(); ++e) tension_[e] = states_[e].tension;
  assemble(Tangent::exact);
  if (matrix_.factor()) return false;
  // Rounding makes a slender chain indefinite by 1e-13 of its diagonal, see factor().
  for (Index i = 0; i < nodes(); ++i) matrix_.diagonal(i).diagonal() *= 1 + 1e-10;
  return !matrix_.factor();
}

/// Along a direction of negative curvature, as far as the potential falls.
bool Rod::leave_saddle() {
  if (!force_.isZero(0) || !buckles()) return false;
  matrix_.negative_direction(elements_[0].length, answer_);
  const Real turn = largest_turn(pose_, answer_);
  if (!(turn > 0)) return false;
  const Real downhill = missing_.dot(answer_) < 0 ? -1 : 1;
  answer_ *= downhill * 1e-3 / turn;  // by a milliradian first
  Real lowest = potential();
  for (Real part = 1; part < 1e3 * turn_limit; part *= 2) {
    motion_ += part * answer_;
    take_motion();
    const Real now = potential();
    if (now < lowest) {
      lowest = now;
      continue;
    }
    motion_ -= part * answer_;
    take_motion();
    if (part == 1) return false;
    break;
  }
  for (Index e = 0; e < beams(); ++e) tension_[e] = states_[e].tension;
  last_turn_ = std::numeric_limits<Real>::infinity();
  return true;
}

}  // namespace sutura::thread
