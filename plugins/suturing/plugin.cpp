// Plugin "suturing": puncture, cutting, suture path, path friction.
#include "sutura/plugin.h"

#include "cutting.h"
#include "cutting_law.h"
#include "path_friction.h"
#include "path_friction_law.h"
#include "puncture.h"
#include "puncture_law.h"
#include "suture_path.h"

namespace {

void enrol_suturing(sutura::Registry& registry) {
  registry.law<sutura::suturing::PunctureLaw>();
  registry.law<sutura::suturing::CuttingLaw>();
  registry.law<sutura::suturing::PathFrictionLaw>();
  registry.component<sutura::suturing::SuturePath>("SuturePath");
  registry.component<sutura::suturing::Cutting>("Cutting");
  registry.component<sutura::suturing::Puncture>("Puncture");
  registry.component<sutura::suturing::PathFriction>("PathFriction");
}

}  // namespace

SUTURA_PLUGIN(suturing, "0.1.0", "Apache-2.0", enrol_suturing)
