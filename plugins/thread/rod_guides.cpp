// The free motion of a rod that constraints lead along a path: it is linearised where they are expected to hold it.
//
// A taut thread that slides round a corner turns by slip / radius in a step, and its constraints decide where to. Linearised
// anywhere else, the answer of its rows is wrong by the stretch that this turn fakes, times EA: a drag that grows with the
// step and that no friction law knows of. So the rod first moves by Newton as if springs held it sideways at its guides; the
// free motion is then the linear answer from there, without guides and without the constraint forces of the last step.
#include <algorithm>
#include <cmath>

#include "curve.h"
#include "rod.h"

namespace sutura::thread {
namespace {

/// About what half a millimetre of thread resists with when it is bent across (192 EI / L^3): softer would not lead, much
/// stiffer would only cost Newton corrections.
constexpr Real guide_stiffness = 1e5;  // N/m

void add_force(const Rod& rod, Real s, const Vec3& force, VecX& sum) {
  PointJacobian J;
  curve_jacobian(rod, s, Configuration::current, J);
  for (int k = 0; k < J.nodes; ++k)
    sum.segment<6>(6 * J.node[k]) += J.coefficients.middleCols<6>(6 * k).transpose() * force;
}

}  // namespace

/// The springs of the guides at the free poses: to rhs_ and matrix_.
void Rod::apply_guides(Real dt) {
  using Mat36 = Eigen::Matrix<Real, 3, 6>;
  PointJacobian J;
  for (const Guide& g : guides_) {
    curve_jacobian(*this, g.abscissa, Configuration::free, J);
    Mat36 j[2];
    for (int k = 0; k < 2; ++k) {
      const bool fixed = std::find(clamped_.begin(), clamped_.end(), J.node[k]) != clamped_.end();
      if (fixed) j[k].setZero();
      else j[k] = J.coefficients.middleCols<6>(6 * k);
      j[k] -= g.tangent * (g.tangent.transpose() * j[k]).eval();  // across the guide
    }
    const Vec3 gap = curve_point(*this, g.abscissa, Configuration::free) - g.point;
    const Real k = guide_stiffness;
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
    sum += guide_stiffness / 2 * (gap.squaredNorm() - std::pow(gap.dot(g.tangent), 2));
  }
  return sum;
}

/// False if a matrix cannot be factored; the expected constraint forces are then what they were.
bool Rod::guided_motion(Real dt, const Vec3& gravity) {
  constexpr int most_corrections = 20;
  constexpr Real settled = 0.02;  // rad; what is left after such a correction is its square
  last_force_ = constraint_force_;
  for (const Guide& g : guides_) add_force(*this, g.acted_at, -g.force, constraint_force_);
  keep_ = 1;
  passes_ = 1;
  start_by_inertia(dt, gravity);
  if (lower_potential(dt, gravity, most_corrections, settled)) {
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
