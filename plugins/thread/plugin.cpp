#include "sutura/plugin.h"

#include "suture_thread.h"

static void enrol_thread(sutura::Registry& registry) {
  registry.component<sutura::thread::SutureThread>("SutureThread");
}
SUTURA_PLUGIN(thread, "0.1.0", "Apache-2.0", enrol_thread)
