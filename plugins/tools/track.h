// Track: where a tool is at any time, from key frames in the scene or in a CSV file.
#pragma once

#include <vector>

#include "key_frames.h"
#include "sutura/body.h"
#include "sutura/describe.h"
#include "sutura/simulation.h"

namespace sutura::tools {

class Track : public Component, public Driver, public Motion {
 public:
  static constexpr const char* interface_name = "Track";
  static void describe(Describe<Track>& d);

  void initialise(Setup& setup) override;
  void drive(const StepContext& context) override { now_ = frames_.at(context.end()); }

  /// The rigid motion of space at `time` (see key_frames.h); the pose of the tool, if the tool was
  /// modelled at the origin.
  Pose at(Real time) const override { return frames_.at(time); }

 private:
  std::vector<KeyFrame> keys_from_attributes(Setup& setup);
  std::vector<KeyFrame> keys_from_file(Setup& setup);
  bool find_axis(Setup& setup);

  std::vector<Real> times_;
  std::vector<Real> positions_;
  std::vector<Real> rotations_;
  std::vector<Real> turns_;
  Link<CurveBody> about_;
  File file_;
  Vec3 centre_ = Vec3::Zero();
  Easing easing_ = Easing::linear;

  Vec3 axis_ = Vec3::Zero();  ///< of the needle that `about` names
  KeyFrames frames_;
  Pose now_;  ///< at the end of the last step, for the outputs
};

}  // namespace sutura::tools
