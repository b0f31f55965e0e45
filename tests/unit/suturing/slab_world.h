// The real suturing components and the smallest bodies to run them on.
#pragma once

#include "cutting.h"
#include "fake_bodies.h"
#include "path_friction.h"
#include "puncture.h"
#include "sutura/simulation.h"
#include "suture_path.h"

namespace sutura::testing {

using namespace suturing;

inline void enrol_slab_world(Registry& registry) {
  enrol_builtin(registry);
  registry.component<RigidNeedle>("RigidNeedle");
  registry.component<SpringSlab>("SpringSlab");
  registry.component<SuturePath>("SuturePath");
  registry.component<Cutting>("Cutting");
  registry.component<Puncture>("Puncture");
  registry.component<PathFriction>("PathFriction");
}

}  // namespace sutura::testing
