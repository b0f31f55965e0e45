// Many copies of one small problem that advance together on a device, as learning asks for it:
//
//   auto* batch = dynamic_cast<Batch*>(simulation->find("/batch"));
//   batch->reset({});
//   batch->step(actions);       // environments x actions
//   batch->observe(observed);   // environments x observations
#pragma once

#include <cstdint>
#include <span>

#include "sutura/types.h"

namespace sutura {

/// Rows are environments. Equal rows of actions since equal resets give rows of observations that
/// are equal bit by bit. A device that fails, or an array of the wrong size, throws DeviceError
/// (device.h).
class Batch {
 public:
  static constexpr const char* interface_name = "Batch";
  virtual ~Batch() = default;
  virtual Index environments() const = 0;
  virtual Index actions() const = 0;       ///< per environment
  virtual Index observations() const = 0;  ///< per environment
  /// Back to the beginning: environments whose entry is not zero; all of them if `which` is empty.
  virtual void reset(std::span<const std::uint8_t> which) = 0;
  /// All of them, by the time step of the scene.
  virtual void step(std::span<const Real> actions) = 0;
  virtual void observe(std::span<Real> out) const = 0;
};

}  // namespace sutura
