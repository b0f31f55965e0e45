#include "common_motion.h"

#include <Eigen/Eigenvalues>

namespace sutura::thread {

namespace {

/// Alone: forces of constraints have no sum.
bool pushes_itself(const Rod& rod, const Dofs& force) {
  constexpr Real rounding = 1e-6;
  Vec3 sum = Vec3::Zero();
  Real sizes = 0;
  for (Index i = 0; i < rod.nodes(); ++i) {
    sum += force.segment<3>(6 * i);
    sizes += force.segment<3>(6 * i).norm();
  }
  return sizes > 0 && sum.norm() <= rounding * sizes;
}

/// add(weight, place, velocity) for all that tells how the rod moves as a whole.
template <class Add>
void each_point(const Rod& rod, Real dt, const Add& add) {
  if (rod.is_held()) {
    for (const NodeSpring& s : rod.springs())
      if (s.active) add(Real(1), s.target.position, Vec3((s.target.position - s.last_target) / dt));
    return;
  }
  for (Index e = 0; e < rod.beams(); ++e)
    for (const Index i : {e, e + 1})
      add(rod.element(e).mass / 2, rod.poses()[i].position, Vec3(rod.velocity().segment<3>(6 * i)));
}

/// The spin about the centre that has the moment of momentum of all points.
Vec3 spin_about(const Rod& rod, Real dt, const Vec3& centre, const Vec3& shift) {
  Mat3 inertia = Mat3::Zero();
  Vec3 momentum = Vec3::Zero();
  each_point(rod, dt, [&](Real weight, const Vec3& at, const Vec3& v) {
    const Vec3 r = at - centre;
    inertia += weight * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
    momentum += weight * r.cross(v - shift);
  });
  // Points on a line say nothing of a turn about it.
  constexpr Real on_a_line = 1e-6;
  Eigen::SelfAdjointEigenSolver<Mat3> eigen;
  eigen.computeDirect(inertia);
  Vec3 spin = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    const Vec3 axis = eigen.eigenvectors().col(k);
    const Real about = eigen.eigenvalues()[k];
    if (about > on_a_line * eigen.eigenvalues()[2]) spin += axis.dot(momentum) / about * axis;
  }
  return spin;
}

}  // namespace

void find_common_motion(const Rod& rod, const Dofs& force, Real dt, DofVector& velocity) {
  velocity.setZero();
  if (!rod.clamped().empty() || !pushes_itself(rod, force)) return;
  Real whole = 0;
  Vec3 centre = Vec3::Zero(), shift = Vec3::Zero();
  each_point(rod, dt, [&](Real weight, const Vec3& at, const Vec3& v) {
    whole += weight;
    centre += weight * at;
    shift += weight * v;
  });
  centre /= whole;
  shift /= whole;
  // A loop that jaws hold by rows swings about the line between them: that is no motion of all.
  const Vec3 spin = rod.is_held() ? spin_about(rod, dt, centre, shift) : Vec3(Vec3::Zero());
  // Hands that draw it do not carry it, and what is at rest but for rounding goes nowhere.
  constexpr Real aside = 0.1;
  Real squares = 0, off = 0;
  each_point(rod, dt, [&](Real weight, const Vec3& at, const Vec3& v) {
    squares += weight * v.squaredNorm();
    off += weight * (v - shift - spin.cross(at - centre)).squaredNorm();
  });
  if (off > aside * aside * squares) return;
  for (Index i = 0; i < rod.nodes(); ++i) {
    velocity.segment<3>(6 * i) = shift + spin.cross(rod.poses()[i].position - centre);
    velocity.segment<3>(6 * i + 3) = spin;
  }
}

}  // namespace sutura::thread
