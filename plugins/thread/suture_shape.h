// The shape of a suture: a needle bent to an arc, and the thread behind it. Gives section poses by
// abscissa (0 = needle tip), at rest and as laid out at the start.
#pragma once

#include <optional>

#include "rest_shape.h"

namespace sutura::thread {

struct SutureShape {
  Real needle_length = 0;  ///< m
  Real needle_angle = 0;   ///< rad; 0 is a straight needle
  Real thread_length = 0;  ///< m
  Vec3 tip = Vec3::Zero();
  Vec3 tip_direction = Vec3::UnitX();    ///< where the tip points
  Vec3 plane_normal = Vec3::UnitZ();     ///< turning right-handed about it advances the needle
  Vec3 thread_direction = Vec3::Zero();  ///< of the thread as laid out; zero: along the swage
  Real thread_bend_radius = 5e-3;        ///< of the bend from the swage to thread_direction, m
  RestShape thread_rest;                 ///< memory of the spool
  std::optional<RestShape> thread_start = {};  ///< as laid out, in place of the bend

  Real length() const { return needle_length + thread_length; }
  Pose rest(Real s) const;
  Pose start(Real s) const;

 private:
  Pose needle(Real s) const;
};

}  // namespace sutura::thread
