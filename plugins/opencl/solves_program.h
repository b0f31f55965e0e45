// The kernels of solves.cl.
#pragma once

#include "gradients.h"

namespace sutura::opencl {

/// `rough`: the factor is in single precision.
struct Solves::Program {
  Program(const Device& device, Precision precision, bool rough);
  ~Program();
  bool rough;
  cl_program program;
  Kernel invert_tiles, invert_columns, multiply_below, forward, back, subtrees, back_subtrees,
      units, entries;
};

}  // namespace sutura::opencl
