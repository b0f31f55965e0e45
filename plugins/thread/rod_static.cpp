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
    potential += thread::elastic_energy(r, s) -
                 weight.dot((pose_[e].position + pose_[e + 1].position) / 2 +
                            r.length / 12 * (s.ta - s.tb));
  }
  for (Index i = 0; i < nodes(); ++i) potential -= load.segment<3>(6 * i).dot(pose_[i].position);
  for (const NodeSpring& spring : springs_) {
    if (!spring.active) continue;
    const Pose& p = pose_[spring.node];
    const Vec3 d = spring.target.position - p.position;
    const Vec3 w = rotation_between(p.rotation, spring.target.rotation);
    residual.segment<3>(6 * spring.node) += spring.stiffness.translation * d;
    residual.segment<3>(6 * spring.node + 3) += spring.stiffness.rotation * w;
    potential += (spring.stiffness.translation * d.squaredNorm() +
                  spring.stiffness.rotation * w.squaredNorm()) / 2;
  }
  for (const Index node : clamped_) residual.segment<6>(6 * node).setZero();
}

void Rod::assemble_tangent(const Vec3& gravity, BlockTridiagonal& matrix) const {
  matrix.resize(nodes());
  matrix.set_zero();
  ElementState s;
  Mat9 k9;
  for (Index e = 0; e < beams(); ++e) {
    const ElementRest& r = elements_[e];
    element_state(e, s);
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

Rod::StaticReport Rod::equilibrium(const Vec3& gravity, const VecX& load, Real tolerance,
                                   int max_iterations) {
  const Real spacing = abscissa_.back() / static_cast<Real>(beams());
  velocity_.setZero();
  BlockTridiagonal tangent, shifted;
  VecX r(dofs()), trial(dofs()), step(dofs());
  Real potential = 0;
  StaticReport report;
  const auto size = [&](const VecX& f) {
    Real largest = 0;
    for (Index i = 0; i < nodes(); ++i)
      largest = std::max({largest, f.segment<3>(6 * i).norm(), f.segment<3>(6 * i + 3).norm() / spacing});
    return largest;
  };
  static_residual(gravity, load, r, potential);
  Real shift = 0;
  for (; report.iterations < max_iterations; ++report.iterations) {
    report.residual = size(r);
    if (report.residual <= tolerance) {
      report.converged = true;
      break;
    }
    assemble_tangent(gravity, tangent);
    // Shift until positive definite: the step then goes downhill. Scaled by each node's own stiffness.
    for (;;) {
      shifted = tangent;
      if (shift > 0)
        for (Index i = 0; i < nodes(); ++i) {
          auto d = shifted.diagonal(i).diagonal().array();
          d.head<3>() += shift;
          d.tail<3>() += shift * spacing * spacing;
        }
      if (shifted.factor()) break;
      shift = std::max(4 * shift, 1e-3 * elements_[0].bend_1 / (spacing * spacing));
      if (!std::isfinite(shift)) return report;
    }
    step = r;
    shifted.solve(Eigen::Ref<VecX>(step));
    const Real slope = r.dot(step);
    const std::vector<Pose> pose = pose_;
    const std::vector<Real> twist = twist_;
    const Real before = potential, residual_before = report.residual;
    Real factor = 1;
    bool accepted = false;
    for (int cut = 0; cut < 30 && !accepted; ++cut, factor /= 2) {
      move(pose, twist, step, factor, pose_, twist_);
      static_residual(gravity, load, trial, potential);
      // Work of moments: exact to second order along the step.
      Real moment_work = 0;
      for (Index i = 0; i < nodes(); ++i)
        moment_work += factor * load.segment<3>(6 * i + 3).dot(step.segment<3>(6 * i + 3));
      const Real rounding = 1e-13 * (std::abs(before) + std::abs(moment_work));
      accepted = potential - moment_work <= before - 1e-4 * factor * slope + rounding ||
                 size(trial) < 0.5 * residual_before;
    }
    if (!accepted) {
      pose_ = pose;
      twist_ = twist;
      static_residual(gravity, load, r, potential);
      if (shift > 1e6 * elements_[0].bend_1 / (spacing * spacing)) break;
      shift = std::max(16 * shift, 1e-3 * elements_[0].bend_1 / (spacing * spacing));
      continue;
    }
    std::swap(r, trial);
    shift = factor > 0.4 ? shift / 8 : shift;
    if (shift < 1e-9 * elements_[0].bend_1 / (spacing * spacing)) shift = 0;
  }
  free_ = pose_;
  return report;
}

}  // namespace sutura::thread
