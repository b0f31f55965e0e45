// Track: where a tool is at any time, from key frames in the scene or in a CSV file.
#pragma once

#include <vector>

#include "key_frames.h"
#include "sutura/body.h"
#include "sutura/describe.h"
#include "sutura/simulation.h"
#include "sutura/tool.h"

namespace sutura::tools {

class Track : public Component, public Driver, public Tool {
 public:
  static constexpr const char* interface_name = "Track";
  static void describe(Describe<Track>& d);

  void initialise(Setup& setup) override;
  void drive(const StepContext& context) override;

  // Tool
  Pose at(Real time) const override;
  void lead(const Pose& pose) override;

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
  Pose now_;       ///< at the end of the last step
  Real time_ = 0;  ///< of now_ (s)
  Real dt_ = 0;

  // Once a host leads: from where, at which time, and where to within the step that follows.
  bool is_led_ = false;
  Real led_since_ = 0;
  Pose from_, to_;
};

}  // namespace sutura::tools
