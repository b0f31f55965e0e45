// Plugin "contact": rigid tools, and what touches what.
#include "sutura/plugin.h"

#include "contact.h"
#include "knots.h"
#include "rigid_tool.h"
#include "sutura/laws/static_friction.h"

namespace {

void enrol_contact(sutura::Registry& registry) {
  registry.component<sutura::contact::RigidTool>("Tool");
  registry.component<sutura::contact::Contact>("Contact");
  registry.component<sutura::contact::Knots>("Knots");
  registry.law<sutura::StaticFriction>();
}

}  // namespace

SUTURA_PLUGIN(contact, "0.1.0", "Apache-2.0", enrol_contact)
