// What a host steers: tools and jaws, in place of the key frames and times of the scene.
#pragma once

#include "sutura/body.h"

namespace sutura {

/// Something that moves as the host says. A Track in a scene is one.
class Tool {
 public:
  static constexpr const char* interface_name = "Tool";
  virtual ~Tool() = default;
  /// The rigid motion of space since the start that takes the tool to where it is at `time` (s).
  virtual Pose at(Real time) const = 0;
  /// At the end of the next step the tool is at `pose`, and stays until it is led on. Key frames
  /// are ignored from then on.
  virtual void lead(const Pose& pose) = 0;
};

/// Something that the host opens and closes. A Grasper in a scene is one.
class Jaws {
 public:
  static constexpr const char* interface_name = "Jaws";
  virtual ~Jaws() = default;
  /// At the start of the next step. The times of the scene are ignored from then on.
  virtual void close() = 0;
  virtual void open() = 0;
  virtual bool closed() const = 0;
  /// On what is held, over the last step (N, N m); zero while open.
  virtual Wrench wrench() const = 0;
};

}  // namespace sutura
