// Corotational tetrahedra on an OpenCL device: the kernels of elements.cl, and what they need.
#pragma once

#include <memory>
#include <vector>

#include "device.h"
#include "precision.h"

namespace sutura::opencl {

/// Positions come as what nodes have moved since rest: in single precision that keeps the digits
/// that strains are made of.
class Elements {
 public:
  Elements(const Device& device, Precision precision);
  ~Elements();

  void set(const TetElementsView& tets, const NodeMatrixView& pattern);
  void set_viscosity(const VecX& moved, Real share);
  /// values <- scale K + diag(diagonal), nine numbers per block; the rest as
  /// ConjugateGradientDevice::assemble has it. Waits.
  void assemble(const VecX& moved, Real scale, const VecX& diagonal, const Buffer& values,
                VecX& force, std::vector<Mat3>& rotations);
  /// turns <- those since rotations `then` of the nodes, for the last assembly.
  void find_turns(const Buffer& then, const Buffer& turns);
  /// Waits.
  void force(const VecX& moved, VecX& force);

 private:
  struct Program;
  void send(Buffer& to, const Real* from, Index count);
  void receive(const Buffer& from, Real* to, Index count);
  void run_elements(const VecX& moved, Real scale);

  const Device& device_;
  Precision precision_;
  std::unique_ptr<Program> program_;
  int tets_ = 0, nodes_ = 0, slots_ = 0;
  Real share_ = 0;
  Buffer node_, gradient_, volume_, moduli_, first_corner_, corner_, first_part_, part_,
      diagonal_of_, moved_, start_, of_tets_, tangent_, deformation_, diagonal_, force_, rotations_;
  std::vector<float> rounded_;
};

}  // namespace sutura::opencl
