// An OpenCL device: which one, and what it is asked. Errors are thrown as sentences; whoever
// uses the device decides whether the CPU takes over.
#pragma once

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include <string>
#include <vector>

#include "sutura/device.h"

namespace sutura::opencl {

enum class DeviceType { any, gpu, cpu, accelerator };

struct DeviceChoice {
  std::string name;  ///< part of the device's name, upper or lower case; empty: any
  DeviceType type = DeviceType::any;
  Index index = 0;     ///< among those that fit
  bool timed = false;  ///< notes how long every kernel takes (see take_times)
};

/// All launches of one kernel.
struct KernelTime {
  std::string name;
  int launches = 0;
  double us = 0;  ///< from the first item to the last, without what a launch costs
};

/// One line for each device of this machine, or a sentence that says that there is none.
std::string list_devices();

class Device {
 public:
  /// Throws DeviceError: no platform, no device, none that fits (and which ones there are).
  explicit Device(const DeviceChoice& choice);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const std::string& name() const { return name_; }
  bool has_double() const { return has_double_; }
  std::size_t largest_group() const { return largest_group_; }
  cl_command_queue queue() const { return queue_; }
  cl_context context() const { return context_; }

  /// Throws DeviceError with the log of the compiler.
  cl_program build(const std::string& source, const std::string& options) const;
  void finish() const;
  /// Like `finish`, for destructors: whoever lent the device memory, or has kernels on it, waits
  /// before that goes. An error does not matter any more.
  void drain() const noexcept;
  /// Throws DeviceError unless `code` is CL_SUCCESS. `what` was done, and to which.
  void check(cl_int code, const char* what, const std::string& which = {}) const;
  /// Of a device that was opened `timed`: what has run since the last call, longest first. Waits.
  std::vector<KernelTime> take_times();
  /// For tests: from now on every call fails as if the device had gone.
  void lose() { lost_ = true; }

 private:
  cl_device_id id_ = nullptr;
  cl_context context_ = nullptr;
  cl_command_queue queue_ = nullptr;
  std::string name_;
  bool has_double_ = false, lost_ = false, timed_ = false;
  std::size_t largest_group_ = 1;
  friend class Kernel;
  struct Launch {
    std::string kernel;
    cl_event event;
  };
  mutable std::vector<Launch> launches_;
};

}  // namespace sutura::opencl
