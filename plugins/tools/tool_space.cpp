#include "tool_space.h"

#include <cstdio>

#include "key_frames.h"
#include "sutura/geometry/poses.h"

namespace sutura::tools {

std::string ToolSpace::place() {
  if (!(axis_.norm() > 0)) return "'axis' is zero; expected a direction in which to close";
  space_.half = size_ / 2;
  const Quat laid = shortest_rotation(Vec3::UnitZ(), axis_);
  as_modelled_ = {centre_, (rotation_from_vector(rotation_) * laid).normalized()};
  return {};
}

Pose ToolSpace::placed(Configuration c) const {
  if (!track_) return as_modelled_;
  return compose(c == Configuration::start ? track_->start_pose() : track_->pose(), as_modelled_);
}

void ToolSpace::count_closing(bool on_something, Real time) {
  on_something_ = on_something_ || on_something;
  if (on_something || in_vain_++ > 0) return;
  first_in_vain_ = time;
  place_in_vain_ = placed(Configuration::start).position;
}

std::string ToolSpace::closed_in_vain(const std::string& nothing) const {
  if (on_something_ || in_vain_ == 0) return {};
  const Vec3 mm = 1e3 * place_in_vain_;
  char text[200];
  std::snprintf(text, sizeof text, "%.4g s, when their centre was at %.4g %.4g %.4g mm",
                first_in_vain_, mm.x(), mm.y(), mm.z());
  return "closed " + (in_vain_ == 1 ? "" : std::to_string(in_vain_) + " times, first ") + "at " +
         text + ", and " + nothing + " between them";
}

void ToolSpace::archive_closings(Archive& a) {
  a("in_vain", in_vain_);
  a("on_something", on_something_);
  a("first_in_vain", first_in_vain_);
  a("place_in_vain", place_in_vain_);
}

std::vector<JawSpace::Stretch>& ToolSpace::look(const SegmentedCurve& curve, Configuration c,
                                                const Pose& frame) {
  curve.segments(c, seen_);
  const Quat back = frame.rotation.conjugate();
  for (CurveSegment& s : seen_) {
    s.xa = seen_from(frame, s.xa), s.xb = seen_from(frame, s.xb);
    s.ma = back * s.ma, s.mb = back * s.mb;
  }
  space_.stretches(seen_, stretches_);
  return stretches_;
}

}  // namespace sutura::tools
