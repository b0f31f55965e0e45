// Corotational tetrahedra on an OpenCL device: the kernels of elements.cl, and what they need.
#pragma once

#include <vector>

#include "program.h"

namespace sutura::opencl {

/// Positions come as what nodes have moved since rest: in single precision that keeps the digits
/// that strains are made of.
class Elements {
 public:
  Elements(const Device& device, Precision precision);

  void set(const TetElementsView& tets, const NodeMatrixView& pattern);
  void set_viscosity(const VecX& moved, Real share);
  /// values <- scale K + diag(diagonal), nine numbers per block; the rest as
  /// ConjugateGradientDevice::assemble has it. Waits.
  void assemble(const VecX& moved, Real scale, const VecX& diagonal, const Numbers& values,
                VecX& force, std::vector<Mat3>& rotations);
  /// turns <- those since rotations `then` of the nodes, for the last assembly.
  void find_turns(const Numbers& then, const Numbers& turns);
  /// Waits.
  void force(const VecX& moved, VecX& force);

 private:
  void run_elements(const VecX& moved, Real scale);

  const Device& device_;
  const std::size_t real_;  ///< bytes
  Program program_;
  int tets_ = 0, nodes_ = 0, slots_ = 0;
  Real share_ = 0;
  Buffer node_{device_}, first_corner_{device_}, corner_{device_}, first_part_{device_},
      part_{device_}, diagonal_of_{device_};
  Numbers gradient_{device_, real_}, volume_{device_, real_}, moduli_{device_, real_},
      moved_{device_, real_}, start_{device_, real_}, of_tets_{device_, real_},
      tangent_{device_, real_}, deformation_{device_, real_}, diagonal_{device_, real_},
      force_{device_, real_}, rotations_{device_, real_};
};

}  // namespace sutura::opencl
