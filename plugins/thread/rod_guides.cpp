// The free motion of a rod that constraints lead along a path: it is linearised where they are expected to hold it.
//
// A taut thread that slides round a corner turns by (slip / radius) in a step, and its constraints decide where to. Linearised
// at any other place, the answer of its rows is wrong by the stretch of that turn times EA: a drag that grows with the step and
// that no friction law knows of. So the rod first moves by Newton as if springs held it laterally at the guides; what it
// does without constraints is then the linear answer from there.
#include <algorithm>

#include "curve.h"
#include "rod.h"

namespace sutura::thread {
namespace {

/// Far above the stiffness of a thread across itself at the length of a millimetre, far below the axial one of a needle.
constexpr Real guide_stiffness = 1e5;  // N/m

void add_force(const Rod& rod, Real s, const Vec3& force, VecX& sum) {
  PointJacobian J;
  curve_jacobian(rod, s, Configuration::current, J);
  for (int k = 0; k < J.nodes; ++k)
    sum.segment<6>(6 * J.node[k]) += J.coefficients.middleCols<6>(6 * k).transpose() * force;
}

}  // namespace

/// Lateral springs at the guides, at the free poses: to rhs_ and matrix_.
void Rod::apply_guides(Real dt) {
  PointJacobian J;
  for (const Guide& g : guides_) {
    curve_jacobian(*this, g.abscissa, Configuration::free, J);
    const Mat3 across = Mat3::Identity() - g.tangent * g.tangent.transpose();
    const Vec3 gap = across * (curve_point(*this, g.abscissa, Configuration::free) - g.point);
    const Index a = J.node[0];
    const Eigen::Matrix<Real, 3, 6> ja = J.coefficients.leftCols<6>(), jb = J.coefficients.rightCols<6>();
    const Eigen::Matrix<Real, 3, 6> ka = guide_stiffness * across * ja, kb = guide_stiffness * across * jb;
    rhs_.segment<6>(6 * a) -= dt * guide_stiffness * ja.transpose() * gap;
    rhs_.segment<6>(6 * a + 6) -= dt * guide_stiffness * jb.transpose() * gap;
    matrix_.diagonal(a) += dt * dt * ja.transpose() * ka;
    matrix_.upper(a) += dt * dt * ja.transpose() * kb;
    matrix_.diagonal(a + 1) += dt * dt * jb.transpose() * kb;
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

/// False if a matrix cannot be factored; nothing is changed then.
bool Rod::guided_motion(Real dt, const Vec3& gravity) {
  constexpr int most_passes = 20;
  constexpr Real settled = 0.02;  // rad; the next correction is its square
  const VecX kept = constraint_force_;
  for (const Guide& g : guides_) add_force(*this, g.acted_at, -g.force, constraint_force_);
  keep_ = 1;
  passes_ = 1;
  free_ = pose_;
  free_twist_ = twist_;
  free_velocity_ = velocity_;
  start_energy_ = free_energy(gravity, true).total();
  if (clamped_.empty())
    for (Index i = 0; i < nodes(); ++i) free_velocity_.segment<3>(6 * i) += dt * gravity;
  move(pose_, twist_, free_velocity_, dt, free_, free_twist_);
  if (lower_potential(dt, gravity, most_passes, settled)) {
    constraint_force_.setZero();
    assemble_at(dt, gravity, free_, free_twist_, free_velocity_, false);
    if (factor()) {
      matrix_.solve(Eigen::Ref<VecX>(rhs_));
      free_correction_ = rhs_;
      free_velocity_ += free_correction_;
      return true;
    }
  }
  constraint_force_ = kept;
  return false;
}

}  // namespace sutura::thread
