// New nodes on a moving rod: on its own cubic, with its momentum.
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "curve.h"
#include "element_mass.h"
#include "rod.h"

namespace sutura::thread {

namespace {

/// Velocity and spin of the moving cubic at a place within a beam.
Vec6 velocity_at(const Rod& rod, const CurvePlace& at) {
  const Index e = at.beam;
  const auto& p = rod.poses(Configuration::current);
  const DofVector& v = rod.velocity();
  const Real L = rod.element(e).length;
  const Vec3 ta = p[e].rotation * Vec3::UnitX(), tb = p[e + 1].rotation * Vec3::UnitX();
  const Vec3 va = v.segment<3>(6 * e), wa = v.segment<3>(6 * e + 3);
  const Vec3 vb = v.segment<3>(6 * e + 6), wb = v.segment<3>(6 * e + 9);
  const auto rate = [&](const std::array<Real, 4>& w) {
    return Vec3(w[0] * va + w[1] * L * wa.cross(ta) + w[2] * vb + w[3] * L * wb.cross(tb));
  };
  const Vec3 slope = Cubic(p[e], p[e + 1], L).slope(at.u);
  const Vec3 t = slope.normalized();
  const Real roll = (1 - at.u) * wa.dot(ta) + at.u * wb.dot(tb);
  Vec6 out;
  out.head<3>() = rate(Cubic::weights(at.u));
  out.tail<3>() = t.cross(rate(Cubic::weight_slopes(at.u))) / slope.norm() + roll * t;
  return out;
}

}  // namespace

void ResampleWork::reserve(std::size_t nodes) {
  layout.abscissa.reserve(nodes);
  layout.rest.reserve(nodes);
  layout.start.reserve(nodes);
  layout.sections.reserve(nodes);
  velocity.reserve(6 * static_cast<Index>(nodes));
  for (auto* reals : {&twist, &strain, &old_abscissa}) reals->reserve(nodes);
  changed.reserve(nodes);
  halves.reserve(nodes);
  concerned.reserve(nodes + 2);
}

void Rod::resample(const std::vector<Real>& abscissa, const std::function<Pose(Real)>& rest,
                   const std::function<Section(Real)>& section) {
  Vec6 before;
  before.head<3>() = momentum();
  before.tail<3>() = angular_momentum();
  const std::size_t n = abscissa.size();
  auto& [layout, velocity, twist, strain, old_abscissa, changed, halves, clamped, nodes_concerned,
         springs] = work_;
  layout.abscissa = abscissa;
  layout.rest.clear();
  layout.start.clear();
  layout.sections.clear();
  twist.assign(n - 1, 0);
  velocity.clear(6 * static_cast<Index>(n));
  changed.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const CurvePlace at = place(*this, abscissa[i]);
    const bool old = at.u < 1e-9 || at.u > 1 - 1e-9;
    const Index node = at.beam + (at.u > 0.5 ? 1 : 0);
    layout.rest.push_back(old ? rest_[node] : rest(abscissa[i]));
    layout.start.push_back(old ? pose_[node]
                               : curve_frame(*this, abscissa[i], Configuration::current));
    velocity.segment<6>(6 * static_cast<Index>(i)) =
        old ? Vec6(velocity_.segment<6>(6 * node)) : velocity_at(*this, at);
    changed[i] = !old;
    if (i > 0) layout.sections.push_back(section((abscissa[i - 1] + abscissa[i]) / 2));
  }
  // The strain that the two halves of a split beam have to keep.
  strain.assign(n, 0);
  halves.assign(n, 0);
  for (std::size_t k = 1; k + 1 < n; ++k) {
    const CurvePlace at = place(*this, abscissa[k]);
    if (!changed[k] || std::abs(abscissa[k - 1] - abscissa_[at.beam]) > 1e-12 ||
        std::abs(abscissa[k + 1] - abscissa_[at.beam + 1]) > 1e-12)
      continue;
    ElementState state;
    element_state(at.beam, state);
    strain[k] = state.strain;
    halves[k] = 1;
  }
  // Twist is spread evenly over a beam: a new beam takes its share of each old one it covers.
  std::size_t i = 0;
  for (Index e = 0; e < beams(); ++e)
    for (i = i > 0 ? i - 1 : 0; i + 1 < n && abscissa[i] < abscissa_[e + 1]; ++i) {
      const Real common =
          std::min(abscissa[i + 1], abscissa_[e + 1]) - std::max(abscissa[i], abscissa_[e]);
      if (common > 0) twist[i] += twist_[e] * common / elements_[e].length;
      if (abscissa[i + 1] < abscissa_[e + 1]) continue;
      ++i;
      break;
    }
  // The neighbours of a node that goes are corrected below too.
  for (Index k = 0; k < nodes(); ++k) {
    const auto right = std::lower_bound(abscissa.begin(), abscissa.end(), abscissa_[k] - 1e-12);
    if (right != abscissa.end() && std::abs(*right - abscissa_[k]) < 1e-12) continue;
    const auto b = static_cast<std::size_t>(right - abscissa.begin());
    changed[b - 1] = changed[b] = 1;
  }
  clamped = clamped_;
  springs = springs_;
  old_abscissa = abscissa_;
  build(layout);
  const auto moved = [this, &old = old_abscissa](Index node) {
    const auto it = std::lower_bound(abscissa_.begin(), abscissa_.end(), old[node] - 1e-12);
    return static_cast<Index>(it - abscissa_.begin());
  };
  for (const Index node : clamped) clamp(moved(node));
  for (NodeSpring spring : springs) {
    spring.node = moved(spring.node);
    springs_.push_back(spring);
  }
  twist_ = twist;
  velocity_ = velocity;

  // Arc lengths of the cubic and of the beams differ in the fourth power of the angle; times EA
  // that is seen. The new node gives way until both halves have the strain of the whole: smallest
  // shift, two Newton steps.
  for (std::size_t k = 1; k + 1 < n; ++k)
    for (int pass = 0; halves[k] && pass < 3; ++pass) {
      ElementState a, b;
      element_state(static_cast<Index>(k) - 1, a);
      element_state(static_cast<Index>(k), b);
      Eigen::Matrix<Real, 2, 3> J;
      J.row(0) = strain_gradient(elements_[k - 1], a).head<3>().transpose();
      J.row(1) = -strain_gradient(elements_[k], b).head<3>().transpose();
      const Vec2 wanted(strain[k] - a.strain, strain[k] - b.strain);
      Eigen::Matrix<Real, 2, 2> jj = J * J.transpose();
      jj.diagonal() *=
          1 + 1e-9;  // a straight beam has one direction only, and nothing to correct across
      pose_[k].position += J.transpose() * (jj.inverse() * wanted);
    }

  // What interpolation loses of momentum goes back as a rigid motion of the nodes concerned. A
  // clamp gives the rod whatever momentum it needs, and must not move.
  if (!clamped_.empty()) return;
  nodes_concerned.clear();
  for (std::size_t k = 0; k < n; ++k)
    if (changed[k]) nodes_concerned.push_back(static_cast<Index>(k));
  if (nodes_concerned.empty()) return;
  if (nodes_concerned.size() < 3) {  // a rotation needs an arm
    const Index a = nodes_concerned.front(), b = nodes_concerned.back();
    if (a > 0) nodes_concerned.insert(nodes_concerned.begin(), a - 1);
    if (b + 1 < nodes()) nodes_concerned.push_back(b + 1);
  }
  Vec3 centre = Vec3::Zero();
  for (const Index k : nodes_concerned)
    centre += pose_[k].position / static_cast<Real>(nodes_concerned.size());
  const auto add_motion = [&](const Vec3& v, const Vec3& w) {
    for (const Index k : work_.concerned) {  // clang 14 captures no structured bindings
      velocity_.segment<3>(6 * k) += v + w.cross(pose_[k].position - centre);
      velocity_.segment<3>(6 * k + 3) += w;
    }
  };
  const auto measure = [&] {
    Vec6 m;
    m.head<3>() = momentum();
    m.tail<3>() = angular_momentum() - centre.cross(Vec3(m.head<3>()));
    return m;
  };
  const Vec6 now = measure();
  Vec6 wanted = before;
  wanted.tail<3>() -= centre.cross(Vec3(before.head<3>()));
  const Real arm = abscissa_.back() / static_cast<Real>(beams());
  Eigen::Matrix<Real, 6, 6> response;
  velocity = velocity_;
  for (int c = 0; c < 6; ++c) {
    velocity_.setZero();
    add_motion(c < 3 ? Vec3(Vec3::Unit(c)) : Vec3::Zero(),
               c < 3 ? Vec3::Zero() : Vec3(Vec3::Unit(c - 3) / arm));
    response.col(c) = measure();
  }
  velocity_ = velocity;
  Vec6 difference = wanted - now;
  response.bottomRows<3>() /= arm;
  difference.tail<3>() /= arm;
  const Vec6 x = response.colPivHouseholderQr().solve(difference);
  add_motion(x.head<3>(), x.tail<3>() / arm);
}

}  // namespace sutura::thread
