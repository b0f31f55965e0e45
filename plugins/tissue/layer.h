// <Layer region="fat" young="5 kPa"/>: the material of one region of a tissue.
#pragma once

#include "elastic_model.h"
#include "sutura/component.h"
#include "sutura/describe.h"
#include "tissue.h"

namespace sutura::tissue {

class Layer : public Component {
 public:
  std::string region;
  Real young = 3e3;
  Real poisson = 0.45;
  Real density = 1000;
  Link<Tissue> tissue;

  static void describe(Describe<Layer>& d);
  void initialise(Setup& setup) override;
};

}  // namespace sutura::tissue
