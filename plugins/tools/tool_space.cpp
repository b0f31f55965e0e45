#include "tool_space.h"

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
