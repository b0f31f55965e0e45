#include "law_twins.h"

#include <array>
#include <cstring>

namespace sutura::opencl {
namespace {

constexpr std::size_t size_of(int reals, int flags) {
  return sizeof(Real) * static_cast<std::size_t>(reals + (flags > 0 ? 1 : 0));
}

constexpr LawTwin twin(std::string_view name, int number, int dim, int reals, int flags = 0) {
  return {name, number, dim, reals, flags, size_of(reals, flags)};
}

// In the order of their numbers.
constexpr std::array<LawTwin, 11> twins{
    twin("bilateral1", 0, 1, 2),    twin("bilateral2", 1, 2, 2),
    twin("bilateral3", 2, 3, 2),    twin("bilateral6", 3, 6, 2),
    twin("unilateral", 4, 1, 1),    twin("coulomb", 5, 3, 2),
    twin("puncture", 6, 3, 11, 1),  twin("cutting", 7, 1, 1),
    twin("path_friction", 8, 1, 4), twin("static_friction", 9, 3, 4),
    twin("turning_force", 10, 2, 2)};

}  // namespace

std::span<const LawTwin> law_twins() {
  return twins;
}

const LawTwin* find_twin(const LawOperations& law) {
  for (const LawTwin& t : twins)
    if (t.name == law.name && t.dim == law.dim && t.size == law.params_size) return &t;
  return nullptr;
}

void read_parameters(const LawTwin& twin, const void* params, Real* out) {
  std::memcpy(out, params, sizeof(Real) * static_cast<std::size_t>(twin.reals));
  const auto* flags =
      static_cast<const std::byte*>(params) + sizeof(Real) * static_cast<std::size_t>(twin.reals);
  for (int i = 0; i < twin.flags; ++i) out[twin.reals + i] = flags[i] != std::byte{0} ? 1 : 0;
}

}  // namespace sutura::opencl
