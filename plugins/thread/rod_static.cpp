// Static equilibrium of the rod: Newton on the gradient of the potential, with its exact Hessian.
#include <algorithm>
#include <cmath>

#include "rod.h"

namespace sutura::thread {

void Rod::static_residual(const Vec3& gravity, const VecX& load, VecX& residual, Real& potential) {
  residual = load;
  potential = 0;
  ElementState s;
  for (Index e = 0; e < beams(); ++e) {
    const ElementRest& r = elements_[e];
    evaluate(r, pose_[e], pose_[e + 1], twist_[e], s);
    twist_[e] = s.twist;
    const ElementGradient g = gradient(r, s);
    const Vec3 weight = r.mass * gravity;
    residual.segment<3>(6 * e) += g.v + weight / 2;
    residual.segment<3>(6 * e + 3) += -g.a + r.length / 12 * s.ta.cross(weight);
    residual.segment<3>(6 * e + 6) += -g.v + weight / 2;
    residual.segment<3>(6 * e + 9) += -g.b - r.length / 12 * s.tb.cross(weight);
    // Weight acts at the centroid of the Hermite cubic.
    potential +=
        thread::elastic_energy(r, s) -
        weight.dot((pose_[e].position + pose_[e + 1].position) / 2 + r.length / 12 * (s.ta - s.tb));
  }
  for (Index i = 0; i < nodes(); ++i) potential -= load.segment<3>(6 * i).dot(pose_[i].position);
  for (const NodeSpring& spring : springs_) {
    if (!spring.active) continue;
    const Wrench w = spring_wrench(spring);
    residual.segment<3>(6 * spring.node) += w.force;
    residual.segment<3>(6 * spring.node + 3) += w.moment;
    potential += w.force.squaredNorm() / (2 * spring.stiffness.translation);
    if (spring.stiffness.rotation > 0)
      potential += w.moment.squaredNorm() / (2 * spring.stiffness.rotation);
  }
  for (const Index node : clamped_) residual.segment<6>(6 * node).setZero();
}

void Rod::assemble_tangent(const Vec3& gravity, BlockTridiagonal& matrix,
                           const std::vector<Real>* tension) const {
  matrix.resize(nodes());
  matrix.set_zero();
  ElementState s;
  Mat9 k9;
  for (Index e = 0; e < beams(); ++e) {
    const ElementRest& r = elements_[e];
    element_state(e, s);
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
  for (const NodeSpring& spring : springs_) {
    if (!spring.active) continue;
    auto diagonal = matrix.diagonal(spring.node).diagonal().array();
    diagonal.head<3>() += spring.stiffness.translation;
    diagonal.tail<3>() += spring.stiffness.rotation;
  }
  for (const Index node : clamped_)
    for (int d = 0; d < 6; ++d) matrix.fix(node, d);
}

Real Rod::largest_turn(const std::vector<Pose>& poses, const Dofs& step) const {
  Real largest = 0;
  for (Index e = 0; e < beams(); ++e) {
    const Vec3 span = poses[e + 1].position - poses[e].position;
    const Real l = span.norm();
    const Vec3 axis = span / l;
    const Vec3 chord = axis.cross(step.segment<3>(6 * e + 6) - step.segment<3>(6 * e)) / l;
    largest = std::max({largest, chord.norm(), axis.cross(step.segment<3>(6 * e + 3)).norm(),
                        axis.cross(step.segment<3>(6 * e + 9)).norm()});
  }
  return largest;
}

// Newton with the tension as an unknown of its own, condensed beam by beam: the right-hand side is
// that of the displacement form, but the geometric stiffness takes the tension predicted by the
// last step, EA (strain + strain gradient . step), and not the one that the second-order stretch of
// a finite rotation fakes. It needs no line search where the displacement form creeps (a thread is
// almost inextensible); turning is limited to half a radian per step.
Rod::StaticReport Rod::solve_static(const Vec3& gravity, const VecX& load, Real tolerance,
                                    int max_iterations) {
  const Real spacing = abscissa_.back() / static_cast<Real>(beams());
  const Real unit_stiffness = elements_.back().bend_1 / (spacing * spacing);
  velocity_.setZero();
  BlockTridiagonal tangent, shifted;
  VecX r(dofs()), step(dofs());
  std::vector<Real> tension(static_cast<std::size_t>(beams()));
  Real potential = 0;
  ElementState s;
  for (Index e = 0; e < beams(); ++e) {
    element_state(e, s);
    tension[e] = s.tension;
  }
  Real turning = 0;
  for (Index i = 0; i < nodes(); ++i)
    turning = std::max(turning, load.segment<3>(6 * i + 3).norm() / spacing);
  StaticReport report;
  for (;; ++report.iterations) {
    static_residual(gravity, load, r, potential);
    report.residual = 0;
    for (Index i = 0; i < nodes(); ++i)
      report.residual = std::max(
          {report.residual, r.segment<3>(6 * i).norm(), r.segment<3>(6 * i + 3).norm() / spacing});
    report.converged = report.residual <= tolerance;
    if (report.converged || report.iterations == max_iterations) break;

    assemble_tangent(gravity, tangent, &tension);
    // Shift until positive definite: the step then goes downhill. Close to the end not under a
    // moment of fixed axis, which has no potential; nor in the last third of the iterations, in
    // case the equilibrium is an unstable one, to which shifted steps creep.
    const bool as_is = report.residual < turning || report.iterations >= 2 * max_iterations / 3;
    Real shift = 0;
    for (;;) {
      shifted = tangent;
      for (Index i = 0; i < nodes(); ++i) {
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
    const Real factor = std::min(1., turn_limit / largest_turn(pose_, step));
    for (Index e = 0; e < beams(); ++e) {
      element_state(e, s);
      const Real predicted =
          s.tension + elements_[e].axial *
                          strain_gradient(elements_[e], s)
                              .dot((Vec9() << step.segment<3>(6 * e + 6) - step.segment<3>(6 * e),
                                    step.segment<3>(6 * e + 3), step.segment<3>(6 * e + 9))
                                       .finished());
      tension[e] += factor * (predicted - tension[e]);
    }
    step *= factor;
    move(pose_, twist_, step, pose_, twist_);
  }
  return report;
}

Rod::StaticReport Rod::equilibrium(const Vec3& gravity, const VecX& load, Real tolerance,
                                   int max_iterations) {
  const std::vector<Pose> pose = pose_;
  const std::vector<Real> twist = twist_;
  StaticReport report = solve_static(gravity, load, tolerance, max_iterations);
  if (!report.converged) {  // too far in one go: follow the load
    pose_ = pose;
    twist_ = twist;
    constexpr int increments = 20;
    for (int i = 1; i <= increments; ++i) {
      const Real part = static_cast<Real>(i) / increments;
      const int before = report.iterations;
      report = solve_static(part * gravity, part * load, tolerance, max_iterations);
      report.iterations += before;
    }
  }
  return report;
}

}  // namespace sutura::thread
