// Track: where a tool is at any time, from key frames in the scene or in a CSV file, or from a
// host.
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
  void archive(Archive& archive) override;
  void drive(const StepContext& context) override;

  // Tool
  Pose pose() const override { return now_; }
  Pose start_pose() const override { return before_; }
  void move_to(const Pose& pose) override;
  Pose half_way() const override { return half_way_; }

 private:
  Pose on_the_way(Real time) const;
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

  Vec3 pivot_ = Vec3::Zero();  ///< about which it turns: `centre`, or that of the needle
  Vec3 axis_ = Vec3::Zero();   ///< of the needle that `about` names
  KeyFrames frames_;
  Pose before_, now_;  ///< at the start and the end of the last step
  Pose half_way_;      ///< between them in time
  Real dt_ = 0;        ///< of a whole step, s

  // Told by a host: from where it was when the step began to the target at its end.
  bool told_ = false;
  Pose target_, from_;
  Index step_ = -1;      ///< in which `from_` was noted
  Real step_begin_ = 0;  ///< s
};

}  // namespace sutura::tools
