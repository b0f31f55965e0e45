// <Attach box="-25 -15 -10  25 15 -9.9 mm"/>: nodes of a tissue that do not move.
#pragma once

#include <vector>

#include "sutura/component.h"
#include "sutura/describe.h"
#include "tissue.h"

namespace sutura {

class Attach : public Component {
 public:
  std::vector<Real> box;    ///< m: lower corner, upper corner
  std::vector<Real> nodes;  ///< numbers from 0, in the order of the mesh file
  Link<Tissue> tissue;

  static void describe(Describe<Attach>& d);
  void initialise(Setup& setup) override;

 private:
  std::vector<Index> selected_;
};

}  // namespace sutura
