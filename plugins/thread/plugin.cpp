// Plugin "thread": needle and thread as one chain of beams, the limit of its elongation, loads on
// it and probes of it.
#include "sutura/plugin.h"

#include "elongation.h"
#include "suture_thread.h"
#include "thread_load.h"
#include "thread_probe.h"

static void enrol_thread(sutura::Registry& registry) {
  registry.component<sutura::thread::SutureThread>("SutureThread");
  registry.component<sutura::thread::Elongation>("Elongation");
  registry.component<sutura::thread::ThreadLoad>("ThreadLoad");
  registry.component<sutura::thread::ThreadProbe>("ThreadProbe");
}
SUTURA_PLUGIN(thread, "0.1.0", "Apache-2.0", enrol_thread)
