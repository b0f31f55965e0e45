// Plugin "thread": needle and thread as one chain of beams, and the limit of its elongation.
#include "sutura/plugin.h"

#include "elongation.h"
#include "suture_thread.h"

static void enrol_thread(sutura::Registry& registry) {
  registry.component<sutura::thread::SutureThread>("SutureThread");
  registry.component<sutura::thread::Elongation>("Elongation");
}
SUTURA_PLUGIN(thread, "0.1.0", "Apache-2.0", enrol_thread)
