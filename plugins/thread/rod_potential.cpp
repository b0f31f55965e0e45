#include "rod_potential.h"

#include "element_mass.h"

namespace sutura::thread {

Real potential(const Rod& rod, const RodStart& start, const RodGuess& guess) {
  const Real dt = start.dt;
  Real sum = 0;
  for (Index e = 0; e < rod.beams(); ++e) {
    const ElementRest& r = rod.element(e);
    const ElementMass& m = rod.inertia(e);
    const ElementState& s = guess.beams[e];
    const ElementVelocity v(rod.velocity(), e), old(start.velocity, e);
    if (start.damping.stiffness > 0)
      sum += start.damping.stiffness / dt *
             viscous_energy(r, change_of_deformation(rod, start, guess, e));
    sum += dt * start.damping.mass * kinetic(m, s, v);
    // Weight as in the balance (rod_guess.cpp).
    const bool falls = rod.clamped().empty();
    const Vec3 fall = falls ? Vec3(dt * start.gravity) : Vec3::Zero();
    const NodeRates a{v.va - old.va - fall, v.wa.cross(s.ta) - start.tangent_rate[e],
                      v.wa - old.wa};
    const NodeRates b{v.vb - old.vb - fall, v.wb.cross(s.tb) - start.tangent_rate[e + 1],
                      v.wb - old.wb};
    sum += elastic_energy(r, s) + MassTimes(m, s, a, b).squared / 2;
    const Real lever = rod.is_cut(e) ? 0 : r.length / 12;
    if (!falls) sum -= r.mass * start.gravity.dot(dt / 2 * (v.va + v.vb) + lever * (s.ta - s.tb));
  }
  for (const NodeSpring& spring : rod.springs())
    if (spring.active) sum += spring.energy(rod.poses()[spring.node], guess.roll(rod, spring));
  sum -= start.load.dot(guess.motion);
  for (Index i = 0; i < rod.nodes(); ++i) sum -= guess.force.work(rod, i, guess.motion);
  return sum;
}

}  // namespace sutura::thread
