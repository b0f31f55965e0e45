// <Attach box="-25 -15 -10  25 15 -9.9 mm"/>: nodes of a tissue that do not move, or move as told.
#pragma once

#include <vector>

#include "sutura/component.h"
#include "sutura/describe.h"
#include "sutura/simulation.h"
#include "sutura/tool.h"
#include "tissue.h"

namespace sutura::tissue {

class Attach : public Component, public Driver {
 public:
  std::vector<Real> box;    ///< m: lower corner, upper corner
  std::vector<Real> nodes;  ///< numbers from 0, in the order of the mesh file
  std::string region;
  std::string directions = "xyz";
  Link<Tissue> tissue;
  Link<Tool> motion;

  static void describe(Describe<Attach>& d);
  void initialise(Setup& setup) override;
  void drive(const StepContext& context) override;

 private:
  std::vector<Index> selected_;
  Vec3 along_ = Vec3::Zero();   ///< 1 along the directions held, else 0
  bool slides_ = false;         ///< some directions stay free
  std::vector<Index> handles_;  ///< of supports, or of carriers; one per node
};

}  // namespace sutura::tissue
