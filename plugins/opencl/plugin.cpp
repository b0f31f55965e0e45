#include "sutura/plugin.h"

#include "opencl_device.h"
#include "thread_batch.h"

namespace {

void enrol(sutura::Registry& registry) {
  registry.component<sutura::opencl::OpenClDevice>("OpenClDevice");
  registry.component<sutura::opencl::ThreadBatch>("ThreadBatch");
  registry.devices(&sutura::opencl::list_devices);
}

}  // namespace

SUTURA_PLUGIN(opencl, "0.1.0", "Apache-2.0", enrol)
