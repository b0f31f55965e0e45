// Which laws have a twin in laws.cl, and what their parameters are there: the numbers of
// Law::Params in their order, all of the device's precision.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "sutura/constraints.h"

namespace sutura::opencl {

struct LawTwin {
  std::string_view name;  ///< of the law
  int number;             ///< in laws.cl
  int dim;
  int reals, flags;  ///< Params are so many Real, then so many bool
  std::size_t size;  ///< of Params
  static constexpr int most_parameters = 16;
  int parameters() const { return reals + flags; }
};

/// Null if there is none, or if its parameters have another size than the twin knows.
const LawTwin* find_twin(const LawOperations& law);
std::span<const LawTwin> law_twins();

/// parameters() numbers.
void read_parameters(const LawTwin& twin, const void* params, Real* out);

}  // namespace sutura::opencl
