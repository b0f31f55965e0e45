// The kernels of solves.cl and many_solves.cl, and what the latter need.
#pragma once

#include "gradients.h"
#include "programs.h"

namespace sutura::opencl {

/// `more`: appended to solves.cl. `rough`: the factor is in single precision.
cl_program build_solves(const Device& device, Precision precision, bool rough, const char* more);

struct Solves::Program {
  Program(const Device& device, Precision precision, bool rough);
  ~Program();
  bool rough;
  cl_program program;
  Kernel invert_tiles, invert_columns, multiply_below, forward, back, subtrees, back_subtrees;
};

struct Solves::Many {
  Many(const Device& device, Precision precision, bool rough);
  ~Many();
  bool rough;
  cl_program program;
  Kernel rows, back, subtrees, back_subtrees, units, pick;
  Buffer b, left, y, x, positions, rows_wanted, picked;
  std::vector<std::int32_t> wanted;
  std::vector<double> doubles;
  std::vector<float> floats;
};

}  // namespace sutura::opencl
