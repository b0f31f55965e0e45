#include "layer.h"

#include "tet_mesh.h"

namespace sutura {

void Layer::describe(Describe<Layer>& d) {
  d.summary("The material of one region of a tissue, in place of the tissue's own.");
  d.attribute("region", &Layer::region, "Name or number of the region in the mesh.").required();
  d.attribute("young", &Layer::young, "Pa", above(0), "Young modulus.");
  d.attribute("poisson", &Layer::poisson, "1", strictly_between(-1, 0.5), "Poisson ratio.");
  d.attribute("density", &Layer::density, "kg/m^3", above(0), "Density.");
  d.link("tissue", &Layer::tissue, "The tissue that has this region.");
}

void Layer::initialise(Setup& setup) {
  if (!tissue->ok()) return;  // its mesh has been complained about
  std::string error;
  const std::optional<int> tag = tissue->mesh->region(region, error);
  if (!tag) return setup.error(*this, error);
  if (!tissue->set_material(*tag, {young, poisson, density}))
    setup.error(*this, "a second layer for region '" + region + "'");
}

}  // namespace sutura
