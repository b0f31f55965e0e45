// The plugin "output": files for ParaView and for plots.
#include "sutura/plugin.h"

#include "constraint_table.h"
#include "csv_probe.h"
#include "distance.h"
#include "energy_probe.h"
#include "vtu_recorder.h"

namespace {
void enrol_output(sutura::Registry& registry) {
  registry.component<sutura::output::VtuRecorder>("VtuRecorder");
  registry.component<sutura::output::CsvProbe>("CsvProbe");
  registry.component<sutura::output::ConstraintTable>("ConstraintTable");
  registry.component<sutura::output::Distance>("Distance");
  registry.component<sutura::output::EnergyProbe>("EnergyProbe");
}
}  // namespace

SUTURA_PLUGIN(output, "0.1.0", "Apache-2.0", enrol_output)
