// Newton on the gradient of the potential, with its exact Hessian.
#include "rod_static.h"

#include <algorithm>
#include <cmath>

#include "dead_moment.h"
#include "rod_way.h"

namespace sutura::thread {

void assemble_static(const Rod& rod, const Vec3& gravity, BlockTridiagonal& matrix,
                     const std::vector<Real>* tension) {
  matrix.resize(rod.nodes());
  matrix.set_zero();
  ElementState s;
  Mat9 k9;
  for (Index e = 0; e < rod.beams(); ++e) {
    const ElementRest& r = rod.element(e);
    rod.element_state(e, s);
    if (tension) s.tension = (*tension)[e];
    hessian(r, s, k9);
    const auto hang = [&](const Vec3& t, Real sign, int block) {
      const Vec3 w = r.mass * gravity;
      const Mat3 wt = w * t.transpose();
      k9.block<3, 3>(block, block) -=
          sign * r.length / 12 * ((wt + wt.transpose()) / 2 - w.dot(t) * Mat3::Identity());
    };
    hang(s.ta, 1, 3);
    hang(s.tb, -1, 6);
    const Mat12 k = expand(k9);
    matrix.diagonal(e) += k.topLeftCorner<6, 6>();
    matrix.diagonal(e + 1) += k.bottomRightCorner<6, 6>();
    matrix.upper(e) = k.topRightCorner<6, 6>();
  }
  for (const NodeSpring& spring : rod.springs()) {
    if (!spring.active) continue;
    auto diagonal = matrix.diagonal(spring.node).diagonal().array();
    diagonal.head<3>() += spring.stiffness.translation;
    diagonal.tail<3>() += spring.stiffness.rotation;
  }
  for (const Index node : rod.clamped())
    for (int d = 0; d < 6; ++d) matrix.fix(node, d);
}

namespace {

/// Forces and moments that are not balanced (N, N m; 6 per node).
void static_residual(Rod& rod, const Vec3& gravity, const VecX& load, VecX& residual) {
  residual = load;
  ElementState s;
  for (Index e = 0; e < rod.beams(); ++e) {
    const ElementRest& r = rod.element(e);
    rod.element_state(e, s);
    rod.twist()[e] = s.twist;
    const ElementGradient g = gradient(r, s);
    const Vec3 weight = r.mass * gravity;  // at the centroid of the Hermite cubic
    residual.segment<3>(6 * e) += g.v + weight / 2;
    residual.segment<3>(6 * e + 3) += -g.a + r.length / 12 * s.ta.cross(weight);
    residual.segment<3>(6 * e + 6) += -g.v + weight / 2;
    residual.segment<3>(6 * e + 9) += -g.b - r.length / 12 * s.tb.cross(weight);
  }
  for (const NodeSpring& spring : rod.springs()) {
    if (!spring.active) continue;
    const Wrench w = spring.wrench(rod.poses()[spring.node]);
    residual.segment<3>(6 * spring.node) += w.force;
    residual.segment<3>(6 * spring.node + 3) += w.moment;
  }
  for (const Index node : rod.clamped()) residual.segment<6>(6 * node).setZero();
}

/// Largest force in a vector over the dofs (N), moments divided by `length`.
Real largest_force(const VecX& r, Real length) {
  Real largest = 0;
  for (Index i = 0; i < r.size(); i += 6)
    largest = std::max({largest, r.segment<3>(i).norm(), r.segment<3>(i + 3).norm() / length});
  return largest;
}

// Newton with the tension as an unknown of its own, condensed beam by beam: the right-hand side is
// that of the displacement form, but the geometric stiffness takes the tension predicted by the
// last step, EA (strain + strain gradient . step), and not the one that the second-order stretch of
// a finite rotation fakes. It needs no line search where the displacement form creeps (a thread is
// almost inextensible); turning is limited to half a radian per step.
StaticReport solve_static(Rod& rod, const Vec3& gravity, const VecX& load, Real tolerance,
                          int max_iterations) {
  const Real spacing = rod.abscissa().back() / static_cast<Real>(rod.beams());
  const Real unit_stiffness = rod.element(rod.beams() - 1).bend_1 / (spacing * spacing);
  rod.velocity().setZero();
  BlockTridiagonal tangent, shifted;
  DeadMoments moments;
  VecX r(rod.dofs()), step(rod.dofs());
  std::vector<Real> tension(static_cast<std::size_t>(rod.beams()));
  ElementState s;
  for (Index e = 0; e < rod.beams(); ++e) {
    rod.element_state(e, s);
    tension[e] = s.tension;
  }
  Real turning = 0;
  for (Index i = 0; i < rod.nodes(); ++i)
    turning = std::max(turning, load.segment<3>(6 * i + 3).norm() / spacing);
  StaticReport report;
  for (;; ++report.iterations) {
    static_residual(rod, gravity, load, r);
    report.residual = largest_force(r, spacing);
    report.converged = report.residual <= tolerance;
    if (report.converged || report.iterations == max_iterations) break;

    assemble_static(rod, gravity, tangent, &tension);
    // Shift until positive definite: the step then goes downhill. Close to the end not under a
    // moment of fixed axis, which has no potential; nor in the last third of the iterations, in
    // case the equilibrium is an unstable one, to which shifted steps creep.
    const bool as_is = report.residual < turning || report.iterations >= 2 * max_iterations / 3;
    Real shift = 0;
    for (;;) {
      shifted = tangent;
      for (Index i = 0; i < rod.nodes(); ++i) {
        auto d = shifted.diagonal(i).diagonal().array();
        d.head<3>() += shift;
        d.tail<3>() += shift * spacing * spacing;
      }
      if (shifted.factor(as_is)) break;
      shift = std::max(4 * shift, 1e-6 * unit_stiffness);
      if (!(shift < 1e12 * unit_stiffness)) return report;
    }
    step = r;
    shifted.solve(Eigen::Ref<VecX>(step));
    moments.turn(
        rod, load, 1, [&](MatX& x) { shifted.solve(Eigen::Ref<MatX>(x)); }, step);
    const Real factor = std::min(1., turn_limit / largest_turn(rod, Configuration::current, step));
    for (Index e = 0; e < rod.beams(); ++e) {
      rod.element_state(e, s);
      const Real change = strain_gradient(rod.element(e), s).dot(beam_motion(step, e));
      const Real predicted = s.tension + rod.element(e).axial * change;
      tension[e] += factor * (predicted - tension[e]);
    }
    step *= factor;
    move_chain(rod.poses(), rod.twist(), step, rod.poses(), rod.twist());
  }
  return report;
}

}  // namespace

StaticReport equilibrium(Rod& rod, const Vec3& gravity, const VecX& load, Real tolerance,
                         int max_iterations) {
  const std::vector<Pose> poses = rod.poses();
  const std::vector<Real> twist = rod.twist();
  StaticReport report = solve_static(rod, gravity, load, tolerance, max_iterations);
  if (!report.converged) {  // too far in one go: follow the load
    rod.poses() = poses;
    rod.twist() = twist;
    constexpr int increments = 20;
    for (int i = 1; i <= increments; ++i) {
      const Real part = static_cast<Real>(i) / increments;
      const int before = report.iterations;
      report = solve_static(rod, part * gravity, part * load, tolerance, max_iterations);
      report.iterations += before;
    }
  }
  return report;
}

}  // namespace sutura::thread
