// What a host may do with the tools of a scene, in place of its key frames and times. Found with
// Simulation::find and a dynamic_cast:
//
//   auto* needle_holder = dynamic_cast<Tool*>(simulation->find("/tools/holder_track"));
//   needle_holder->move_to(device_pose);   // before each step
#pragma once

#include "sutura/body.h"

namespace sutura {

/// Something that moves through space: a track that follows key frames, or goes where it is told.
/// Poses are rigid motions of space by which the tool is away from where it was modelled.
class Tool {
 public:
  static constexpr const char* interface_name = "Tool";
  virtual ~Tool() = default;
  /// At the end of the last step; for drivers that link to it, of the step that begins.
  virtual Pose pose() const = 0;
  /// Likewise at the start of that step.
  virtual Pose start_pose() const = 0;
  /// At the end of the next step, and of those after it, the tool is here. From now on its key
  /// frames count no more. `pose` is finite, its rotation a unit quaternion.
  virtual void move_to(const Pose& pose) = 0;
  /// Like `pose`, but half way through that step.
  virtual Pose half_way() const {
    const Pose from = start_pose(), to = pose();
    return {(from.position + to.position) / 2, from.rotation.slerp(Real(1) / 2, to.rotation)};
  }
};

/// Jaws that hold a section of a curve and carry it along with a tool.
class Jaws {
 public:
  static constexpr const char* interface_name = "Jaws";
  virtual ~Jaws() = default;
  /// From the next step on they are closed, or open, until a time of grasp or release in the scene
  /// or the next call says otherwise. Closed jaws that grasp again hold as they did.
  virtual void grasp() = 0;
  virtual void release() = 0;
  virtual bool holding() const = 0;
  /// On what is held, over the last step (N, N m); zero while open.
  virtual Wrench wrench() const = 0;
};

}  // namespace sutura
