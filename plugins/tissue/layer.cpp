#include "layer.h"

#include "material_limits.h"
#include "tet_mesh.h"

namespace sutura::tissue {

void Layer::describe(Describe<Layer>& d) {
  d.summary("The material of one region of a tissue, in place of the tissue's own.");
  d.attribute("region", &Layer::region, "Name or number of the region in the mesh.").required();
  d.attribute("young", &Layer::young, "Pa", young_range, "Young modulus.");
  d.attribute("poisson", &Layer::poisson, "1", strictly_between(-1, 0.5), "Poisson ratio.");
  d.attribute("density", &Layer::density, "kg/m^3", density_range, "Density.");
  d.link("tissue", &Layer::tissue, "The tissue that has this region.");
}

void Layer::initialise(Setup& setup) {
  std::string error;
  const std::optional<int> tag = tissue->mesh->region(region, error);
  if (!tag) return setup.error(*this, "region: " + error);
  if (!tissue->set_material(*tag, {young, poisson, density}))
    return setup.error(*this, "a second layer for region '" + region + "'");
  doubt_material(*this, setup, {young, poisson, density});
  const bool is_said = tissue->poisson > locking_poisson;  // by the tissue itself
  if (tissue->element == TissueElement::unstated && poisson > locking_poisson && !is_said)
    setup.warning(*this, "poisson is " + format_real(poisson) + ", where " + too_stiff);
}

}  // namespace sutura::tissue
