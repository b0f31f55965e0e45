// The free motion of a rod that constraints lead along a path: it is linearised where they are
// expected to hold it.
//
// A taut thread that slides round a corner turns by slip / radius in a step, and its constraints
// decide where to. Linearised anywhere else, the answer of its rows is wrong by the stretch that
// this turn fakes, times EA: a drag that grows with the step and that no friction law knows of. So
// the rod first moves by Newton as if springs held it sideways at its guides; the free motion is
// then the linear answer from there, without guides and without the constraint forces of the last
// step.
#include <algorithm>
#include <cmath>

#include "curve.h"
#include "rod.h"

namespace sutura::thread {
namespace {

/// About what three diameters of thread resist with when they are bent across (192 EI / L^3 = 0.4 E
/// d, 1e5 N/m for 4-0 polypropylene): softer would not lead, much stiffer would only cost Newton
/// corrections. In terms of the thread itself, so that a step does not depend on the unit of
/// length.
Real stiffness_of_guides(const Rod& rod) {
  const Section& thread = rod.section(rod.beams() - 1);
  return 0.4 * thread.young * 2 * thread.radius;
}

void add_force(const Rod& rod, Real s, const Vec3& force, DofVector& sum) {
  PointJacobian J;
  curve_jacobian(rod, s, Configuration::current, J);
  for (int k = 0; k < J.nodes; ++k)
    sum.segment<6>(6 * J.node[k]) += J.coefficients.middleCols<6>(6 * k).transpose() * force;
}

}  // namespace

/// The springs of the guides at the free poses: to rhs_ and matrix_.
void Rod::apply_guides(Real dt) {
  using Mat36 = Eigen::Matrix<Real, 3, 6>;
  const Real k = stiffness_of_guides(*this);
  PointJacobian J;
  for (const Guide& g : guides_) {
    curve_jacobian(*this, g.abscissa, Configuration::free, J);
    Mat36 j[2];
    for (int i = 0; i < 2; ++i) {
      const bool fixed = std::find(clamped_.begin(), clamped_.end(), J.node[i]) != clamped_.end();
      if (fixed)
        j[i].setZero();
      else
        j[i] = J.coefficients.middleCols<6>(6 * i);
      j[i] -= g.tangent * (g.tangent.transpose() * j[i]).eval();  // across the guide
    }
    const Vec3 gap = curve_point(*this, g.abscissa, Configuration::free) - g.point;
    const Index a = J.node[0];
    rhs_.segment<6>(6 * a) -= dt * k * j[0].transpose() * gap;
    rhs_.segment<6>(6 * a + 6) -= dt * k * j[1].transpose() * gap;
    matrix_.diagonal(a) += dt * dt * k * j[0].transpose() * j[0];
    matrix_.upper(a) += dt * dt * k * j[0].transpose() * j[1];
    matrix_.diagonal(a + 1) += dt * dt * k * j[1].transpose() * j[1];
  }
}

Real Rod::guide_energy() const {
  Real sum = 0;
  for (const Guide& g : guides_) {
    const Vec3 gap = curve_point(*this, g.abscissa, Configuration::free) - g.point;
    sum += stiffness_of_guides(*this) / 2 * (gap.squaredNorm() - std::pow(gap.dot(g.tangent), 2));
  }
  return sum;
}

/// Newton with the tension as an unknown of its own may lift the potential on its best way (a turn
/// fakes stretch until the next correction takes it back), so a correction is taken whole while
/// corrections shrink, and shortened when they do not. False if they do not settle.
bool Rod::follow_guides(Real dt, const Vec3& gravity) {
  constexpr int most_corrections = 20;
  constexpr Real settled = 1e-3;  // rad; what is left after such a correction is its square
  constexpr Real close = 0.02;  // rad; where corrections no longer shrink, this is near enough: the
                                // linear answer does the rest
  Real last_turn = 2 * turn_limit, turn = 0;
  for (int i = 0; i < most_corrections; ++i, last_turn = turn) {
    if (!find_correction(dt, gravity, turn)) return false;
    if (turn < last_turn / 2) {
      take_correction(dt, 1);
      if (turn < settled) return true;
    } else if (turn < close) {
      return true;
    } else {
      take_correction(dt, 0);
      take_shortened(dt, gravity, turn, incremental_potential(dt, gravity));
    }
  }
  return turn < 5 * close;
}

/// False if the rod does not settle at its guides, as with a loose end that whips: the linear
/// answer from there could be anything. The expected constraint forces are then what they were.
bool Rod::guided_motion(Real dt, const Vec3& gravity) {
  last_force_ = constraint_force_;
  for (const Guide& g : guides_) add_force(*this, g.acted_at, -g.force, constraint_force_);
  keep_ = 1;
  passes_ = 1;
  start_by_inertia(dt, gravity);
  if (follow_guides(dt, gravity)) {
    constraint_force_.setZero();
    assemble_at(dt, gravity, free_, free_twist_, free_velocity_, false);
    if (factor()) {
      matrix_.solve(Eigen::Ref<VecX>(rhs_));
      free_correction_ = rhs_;
      free_velocity_ += free_correction_;
      return true;
    }
  }
  constraint_force_ = last_force_;
  return false;
}

}  // namespace sutura::thread
