// Touches of something and a rigid tool.
#pragma once

#include "rigid_tool.h"
#include "touch.h"

namespace sutura::contact {

class ToolPair : public Pair {
 public:
  explicit ToolPair(RigidTool& tool) : tool_(tool) {}
  void tell_force(const Touch& touch, const Vec3& force) override {
    tool_.add_force(-force, touch.at);
  }

 protected:
  RigidTool& tool_;
};

}  // namespace sutura::contact
