#include "self_overlap.h"

#include <cstdio>

namespace sutura::tissue {

void SelfOverlap::look(const SolidQueries& now, Real edge_length, Real time) {
  constexpr Index period = 10;
  constexpr Real slack = 1e-3;  // of an edge: walls that lie on each other do not overlap
  if (++steps_ % period != 0) return;
  const std::optional<SurfacePoint> seen = now.deepest_in_itself(slack * edge_length);
  if (!seen || -seen->distance <= deepest_) return;
  deepest_ = -seen->distance;
  time_ = time;
  place_ = seen->position;
}

std::string SelfOverlap::sentence(Real edge_length) const {
  constexpr Real seen = 0.1;
  if (deepest_ <= seen * edge_length) return {};
  const Vec3 mm = 1e3 * place_;
  char text[200];
  std::snprintf(text, sizeof text,
                "walls of it overlapped, by up to %.2g mm at %.4g s at %.4g %.4g %.4g mm; a "
                "<Contact> with nothing but it as 'first' keeps them apart",
                1e3 * deepest_, time_, mm.x(), mm.y(), mm.z());
  return text;
}

void SelfOverlap::archive(Archive& a) {
  a("steps", steps_);
  a("deepest", deepest_);
  a("time", time_);
  a("place", place_);
}

}  // namespace sutura::tissue
