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
  registry.component<sutura::tissue::TetMesh>("TetMesh");
  registry.component<sutura::tissue::BlockMesh>("BlockMesh");
  registry.component<sutura::tissue::Tissue>("Tissue");
  registry.component<sutura::tissue::Layer>("Layer");
  registry.component<sutura::tissue::Attach>("Attach");
  registry.component<sutura::tissue::TissueLoad>("TissueLoad");
  registry.component<sutura::tissue::TissueProbe>("TissueProbe");
  sutura::tissue::enrol_tissue_solvers(registry);
}

}  // namespace

SUTURA_PLUGIN(tissue, "0.1.0", "Apache-2.0", enrol)
