// The space between the jaws of forceps or the blades of scissors: a box that goes with a track.
#pragma once

#include <string>
#include <vector>

#include "jaw_space.h"
#include "sutura/archive.h"
#include "sutura/describe.h"
#include "sutura/simulation.h"
#include "sutura/tool.h"

namespace sutura::tools {

class ToolSpace {
 protected:
  /// `tool`: whose space it is; `sides`: what closes; `between`: what it lies between. T is
  /// the component.
  template <class T>
  static void describe_space(Describe<T>& d, const std::string& tool, const std::string& sides,
                             const std::string& between);
  /// What is wrong with the attributes, in a sentence, or empty.
  std::string place();
  /// Where it is: its origin the centre, z the direction in which it closes.
  Pose placed(Configuration c) const;
  /// The stretches of a curve in it, where it is at `frame`; they stay until the next call.
  std::vector<JawSpace::Stretch>& look(const SegmentedCurve& curve, Configuration c,
                                       const Pose& frame);

  /// They have closed, where they are at the start of a step.
  void count_closing(bool on_something, Real time);
  /// Of those that have closed and never on anything, a sentence; else empty. `nothing`: "no thread
  /// was".
  std::string closed_in_vain(const std::string& nothing) const;
  void archive_closings(Archive& archive);

  JawSpace space_;

 private:
  Link<Tool> track_;
  Vec3 centre_ = Vec3::Zero(), axis_ = Vec3::UnitZ(), rotation_ = Vec3::Zero();
  Vec3 size_{2e-3, 2e-3, 2e-3};
  Pose as_modelled_;
  Index in_vain_ = 0;                  ///< how often they have closed on nothing
  bool on_something_ = false;          ///< ever
  Real first_in_vain_ = 0;             ///< s
  Vec3 place_in_vain_ = Vec3::Zero();  ///< their centre then (m)
  std::vector<CurveSegment> seen_;
  std::vector<JawSpace::Stretch> stretches_;
};

template <class T>
void ToolSpace::describe_space(Describe<T>& d, const std::string& tool, const std::string& sides,
                               const std::string& between) {
  using Vector = Vec3 T::*;
  d.link("track", static_cast<Link<Tool> T::*>(&ToolSpace::track_),
         "The motion of the " + tool + "; left out, where none is in reach: none.")
      .optional();
  d.attribute(
      "centre", static_cast<Vector>(&ToolSpace::centre_), "m", sutura::between(-1e6, 1e6),
      "Middle of the space between the " + between + ", as modelled: before the track moves it.");
  d.attribute("axis", static_cast<Vector>(&ToolSpace::axis_), "1", any(),
              "Direction in which the " + sides +
                  " close, z of the space. Its x and y are where the shortest turn from z to "
                  "'axis' takes them: for 0 0 1 along x and y, for 1 0 0 along -z and y, for "
                  "0 1 0 along x and -z.");
  d.attribute("rotation", static_cast<Vector>(&ToolSpace::rotation_), "rad",
              sutura::between(-1e4, 1e4),
              "Rotation vector about the centre, after the axis has been laid as said.");
  d.attribute("size", static_cast<Vector>(&ToolSpace::size_), "m", sutura::between(1e-6, 1e3),
              "Edges of the space between the " + between + ": along its x, its y and 'axis'.");
}

}  // namespace sutura::tools
