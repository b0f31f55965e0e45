// The plugin "tools": what the surgeon holds.
#include "sutura/plugin.h"

#include "forceps.h"
#include "grasper.h"
#include "scissors.h"
#include "track.h"

namespace {
void enrol_tools(sutura::Registry& registry) {
  registry.component<sutura::tools::Track>("Track");
  registry.component<sutura::tools::Grasper>("Grasper");
  registry.component<sutura::tools::Forceps>("Forceps");
  registry.component<sutura::tools::Scissors>("Scissors");
}
}  // namespace

SUTURA_PLUGIN(tools, "0.1.0", "Apache-2.0", enrol_tools)
