// In which precision a device computes.
#pragma once

#include <string>

#include "device.h"

namespace sutura::opencl {

/// double_: all. mixed: matrices are stored in single precision, sums are double. single: all in
/// single precision, for devices without double.
enum class Precision { automatic, double_, mixed, single };

/// What `automatic` means on this device; throws DeviceError where the device cannot do what is
/// asked.
Precision choose(Precision asked, const Device& device);

/// The types `real` (sums), `store` (matrices) and `raw` (what the host sends of matrices) of the
/// programs.
std::string definitions(Precision precision);

inline bool has_double_sums(Precision p) {
  return p != Precision::single;
}
inline bool stores_double(Precision p) {
  return p == Precision::double_;
}
/// Bytes of a number of the sums, and of one of the matrices.
inline std::size_t size_of_sum(Precision p) {
  return has_double_sums(p) ? 8 : 4;
}
inline std::size_t size_of_entry(Precision p) {
  return stores_double(p) ? 8 : 4;
}

}  // namespace sutura::opencl
