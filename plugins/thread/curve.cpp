#include "curve.h"

#include <algorithm>
#include <cmath>

namespace sutura::thread {

namespace {

Cubic cubic(const Rod& rod, Index beam, Configuration c) {
  const std::vector<Pose>& p = rod.poses(c);
  return {p[beam], p[beam + 1], rod.element(beam).length};
}

}  // namespace

CurvePlace place(const Rod& rod, Real s) {
  const std::vector<Real>& a = rod.abscissa();
  const auto next = std::upper_bound(a.begin() + 1, a.end() - 1, s);
  const Index beam = next - a.begin() - 1;
  return {beam, std::clamp((s - a[beam]) / (a[beam + 1] - a[beam]), 0., 1.)};
}

Vec3 curve_point(const Rod& rod, Real s, Configuration c) {
  const CurvePlace at = place(rod, s);
  return cubic(rod, at.beam, c).point(at.u);
}

Vec3 curve_tangent(const Rod& rod, Real s, Configuration c) {
  const CurvePlace at = place(rod, s);
  return cubic(rod, at.beam, c).slope(at.u).normalized();
}

Pose curve_frame(const Rod& rod, Real s, Configuration c) {
  const CurvePlace at = place(rod, s);
  const std::vector<Pose>& poses = rod.poses(c);
  const Quat& qa = poses[at.beam].rotation;
  const Quat& qb = poses[at.beam + 1].rotation;
  const Cubic curve = cubic(rod, at.beam, c);
  const Vec3 t = curve.slope(at.u).normalized();
  // The frame of a, carried to t without twist; then its share of the twist left over at b. Over
  // one turn per beam the turns come from the state.
  const auto carried = [&](const Vec3& to) {
    return shortest_rotation(qa * Vec3::UnitX(), to) * qa;
  };
  const Quat left = carried(qb * Vec3::UnitX()).conjugate() * qb;
  constexpr Real turn = 2 * std::numbers::pi;
  Real twist = 2 * std::atan2(left.x(), left.w());
  const Real state = rod.twist()[at.beam];
  twist += turn * std::round((state - twist) / turn);
  const Quat roll(Eigen::AngleAxis<Real>(at.u * twist, Vec3::UnitX()));
  return {curve.point(at.u), (carried(t) * roll).normalized()};
}

Real coarse_curve_roll(const Rod& rod, Real s, const Dofs& motion) {
  const CurvePlace at = place(rod, s);
  const auto of_node = [&](Index i) {
    const Vec3 tangent = rod.poses(Configuration::start)[i].rotation * Vec3::UnitX();
    return motion.segment<3>(6 * i + 3).dot(tangent);
  };
  return (1 - at.u) * of_node(at.beam) + at.u * of_node(at.beam + 1);
}

void curve_jacobian(const Rod& rod, Real s, Configuration c, PointJacobian& out) {
  const CurvePlace at = place(rod, s);
  const Cubic curve = cubic(rod, at.beam, c);
  const auto w = Cubic::weights(at.u);
  out.nodes = 2;
  out.width = 6;
  out.node[0] = at.beam;
  out.node[1] = at.beam + 1;
  out.coefficients.resize(3, 12);
  out.coefficients << w[0] * Mat3::Identity(), -w[1] * cross_matrix(curve.ma),
      w[2] * Mat3::Identity(), -w[3] * cross_matrix(curve.mb);
}

void curve_surface_jacobian(const Rod& rod, Real s, const Vec3& arm, PointJacobian& out) {
  curve_jacobian(rod, s, Configuration::current, out);
  const CurvePlace at = place(rod, s);
  const Cubic curve = cubic(rod, at.beam, Configuration::current);
  const auto w = Cubic::weight_slopes(at.u);
  const Vec3 slope = curve.slope(at.u);
  const Vec3 t = slope.normalized();
  // velocity += spin x arm, with spin = t x (rate of the slope) / |slope| + t (t . mean spin).
  const Mat3 turn = -cross_matrix(arm) * cross_matrix(t) / slope.norm();
  const Mat3 roll = -cross_matrix(arm) * t * t.transpose();
  auto& J = out.coefficients;
  J.block<3, 3>(0, 0) += w[0] * turn;
  J.block<3, 3>(0, 3) += (1 - at.u) * roll - w[1] * turn * cross_matrix(curve.ma);
  J.block<3, 3>(0, 6) += w[2] * turn;
  J.block<3, 3>(0, 9) += at.u * roll - w[3] * turn * cross_matrix(curve.mb);
}

namespace {

/// A beam that is cut touches nothing: a point far from everything, and from others of its kind.
void send_away(CurveSegment& s) {
  constexpr Real far = 1e6;  // m
  s.xa = s.xb = far * Vec3(1, 1 + s.from, 1 + s.to);
  s.ma = s.mb = Vec3::Zero();
  s.radius = 0;
  s.cut = true;
}

}  // namespace

void curve_segments(const Rod& rod, Configuration c, std::vector<CurveSegment>& out) {
  out.resize(static_cast<std::size_t>(rod.beams()));
  for (Index e = 0; e < rod.beams(); ++e) {
    const Cubic q = cubic(rod, e, c);
    CurveSegment& s = out[static_cast<std::size_t>(e)];
    s = {.from = rod.abscissa()[e],
         .to = rod.abscissa()[e + 1],
         .xa = q.xa,
         .ma = q.ma,
         .xb = q.xb,
         .mb = q.mb,
         .radius = rod.section(e).radius,
         .rigid = rod.stretches().body_of(e)};
    if (rod.is_cut(e)) send_away(s);
  }
}

Real beam_curvature(const Rod& rod, Index beam) {
  const auto& p = rod.poses();
  const Vec3 ta = p[beam].rotation * Vec3::UnitX(), tb = p[beam + 1].rotation * Vec3::UnitX();
  return std::atan2(ta.cross(tb).norm(), ta.dot(tb)) / rod.element(beam).length;
}

Real curve_closest(const Rod& rod, const Vec3& p, Real guess, Real low, Real high,
                   Configuration c) {
  const std::vector<Real>& a = rod.abscissa();
  low = std::max(low, a.front());
  high = std::min(high, a.back());
  if (!(low < high)) return low;
  guess = std::clamp(guess, low, high);
  Index beam = place(rod, guess).beam;
  // Half the derivative of the squared distance along u; negative: closer ahead.
  const auto rise = [&](const Cubic& q, Real u) { return (q.point(u) - p).dot(q.slope(u)); };
  const auto local = [&](Real s) { return (s - a[beam]) / (a[beam + 1] - a[beam]); };
  Cubic q = cubic(rod, beam, c);
  Real from = local(guess);
  const bool ahead = rise(q, from) < 0;
  // Walk downhill, beam by beam, until the slope turns or the range ends.
  Real to;
  for (;;) {
    const Real limit = ahead ? std::min(1., local(high)) : std::max(0., local(low));
    const Real slope = rise(q, limit);
    if (ahead ? slope >= 0 : slope <= 0) {
      to = limit;
      break;
    }
    const Real end = a[beam] + limit * (a[beam + 1] - a[beam]);
    if (ahead ? end >= high : end <= low) return ahead ? high : low;
    beam += ahead ? 1 : -1;
    if (beam < 0 || beam >= rod.beams()) return ahead ? high : low;
    q = cubic(rod, beam, c);
    from = ahead ? 0 : 1;
  }
  // Newton, kept inside the bracket.
  Real left = std::min(from, to), right = std::max(from, to), u = (left + right) / 2;
  for (int i = 0; i < 40 && right - left > 1e-13; ++i) {
    const Vec3 d = q.point(u) - p, t = q.slope(u);
    const Real f = d.dot(t), df = t.squaredNorm() + d.dot(q.second(u));
    (f < 0 ? left : right) = u;
    Real next = u - f / df;
    if (!(next > left && next < right)) next = (left + right) / 2;
    if (std::abs(next - u) < 1e-14) break;
    u = next;
  }
  return a[beam] + u * (a[beam + 1] - a[beam]);
}

}  // namespace sutura::thread
