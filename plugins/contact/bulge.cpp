#include "bulge.h"

#include "moving_curve.h"
#include "sutura/geometry/poses.h"

namespace sutura::contact {

void ToolWay::look(const RigidTool& tool, bool goes_on) {
  end_ = tool.placed(Configuration::current);
  start_ = goes_on ? end_ : tool.placed_without_spin(Configuration::start);
  half_way_ = goes_on ? end_ : tool.placed_half_way();
  turn_ = start_.rotation.angularDistance(end_.rotation);
  const auto is_end = [&](const Pose& p) {
    return p.position == end_.position && p.rotation.coeffs() == end_.rotation.coeffs();
  };
  is_still_ = is_end(start_) && is_end(half_way_);
}

/// What stays where it is goes round the tool along an arc whose direction turns as the tool does,
/// and that of a needle turns as the needle does. Beyond that the place of the tool half way knows
/// how it swings out: where it turns about one point and goes along by another, or turns back. That
/// counts as far as what it meets does not go with it.
Real ToolWay::bulge(const Vec3& was, const Vec3& is, Real turn) const {
  const Real chord = (is - was).norm();
  const Real arc = arc_height(chord, turn_ + turn);
  if (is_still_) return arc;
  const Vec3 from = at(start_, was), to = at(end_, is);
  const Vec3 middle = seen_from(half_way_, (from + to) / 2);
  const Segment straight{was, is};
  const Real aside = (middle - straight.at(closest_point(middle, straight))).norm();
  const Real if_at_rest = (seen_from(end_, from) - was).norm();
  return std::max(arc, chord < if_at_rest ? chord / if_at_rest * aside : aside);
}

Real ToolWay::bulge(const CurveBody& of, const CurveSegment& was, const CurveSegment& is) const {
  CurveSegment from = was, to = is;  // their directions in space
  from.ma = start_.rotation * was.ma, from.mb = start_.rotation * was.mb;
  to.ma = end_.rotation * is.ma, to.mb = end_.rotation * is.mb;
  const Real turn = turn_of_needle(of, from, to);
  if (is_still_ && turn == 0) return 0;
  Vec3 p[4], q[4];
  MovingCurve::hull(was, p), MovingCurve::hull(is, q);
  Real most = 0;
  for (int k = 0; k < 4; ++k) most = std::max(most, bulge(p[k], q[k], turn));
  return most;
}

Real ToolWay::bulge(const Corners& was, const Corners& is) const {
  Real most = 0;
  for (std::size_t k = 0; k < 3 && !is_still_; ++k) most = std::max(most, bulge(was[k], is[k], 0));
  return most;
}

}  // namespace sutura::contact
