#include "sutura/plugin.h"

#include "attach.h"
#include "block_mesh.h"
#include "layer.h"
#include "solver_components.h"
#include "tet_mesh.h"
#include "tissue.h"
#include "tissue_load.h"
#include "tissue_probe.h"

namespace {

void enrol(sutura::Registry& registry) {
  registry.component<sutura::TetMesh>("TetMesh");
  registry.component<sutura::BlockMesh>("BlockMesh");
  registry.component<sutura::Tissue>("Tissue");
  registry.component<sutura::Layer>("Layer");
  registry.component<sutura::Attach>("Attach");
  registry.component<sutura::TissueLoad>("TissueLoad");
  registry.component<sutura::TissueProbe>("TissueProbe");
  sutura::enrol_tissue_solvers(registry);
}

}  // namespace

SUTURA_PLUGIN(tissue, "0.1.0", "Apache-2.0", enrol)
