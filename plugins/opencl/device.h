// An OpenCL device: which one, its memory, its programs. Errors are thrown as sentences; whoever
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

/// Memory on the device that keeps its size when less is asked for.
class Buffer {
 public:
  explicit Buffer(const Device& device) : device_(&device) {}
  Buffer(Buffer&& other) noexcept;
  Buffer& operator=(Buffer&&) = delete;
  ~Buffer();
  /// At least that many bytes; what was in it is gone if it grows.
  void reserve(std::size_t bytes);
  /// `data` must stay as it is until something is read.
  void write(const void* data, std::size_t bytes);
  /// Likewise, into what it has room for, from this byte on.
  void write_at(std::size_t offset, const void* data, std::size_t bytes);
  /// Waits until that and everything that was asked of the device before is done; without `wait`,
  /// the next one that waits does.
  void read(void* data, std::size_t bytes, bool wait = true) const;
  void read_later(void* data, std::size_t bytes, class Event& read) const;
  template <class T>
  void write(const std::vector<T>& data) {
    write(data.data(), data.size() * sizeof(T));
  }
  template <class T>
  void read(std::vector<T>& data, bool wait = true) const {
    read(data.data(), data.size() * sizeof(T), wait);
  }
  cl_mem get() const { return memory_; }

 private:
  const Device* device_;
  cl_mem memory_ = nullptr;
  std::size_t bytes_ = 0;
};

/// Memory of the host that the device reaches by itself. Drivers wait for a read into any other,
/// also where they are told not to.
class Pinned {
 public:
  Pinned(const Device& device, std::size_t bytes);
  Pinned(const Pinned&) = delete;
  Pinned& operator=(const Pinned&) = delete;
  ~Pinned();
  void* data() const { return data_; }

 private:
  const Device* device_;
  cl_mem memory_ = nullptr;
  void* data_ = nullptr;
};

/// That something which was asked of the device is done.
class Event {
 public:
  Event() = default;
  Event(const Event&) = delete;
  Event& operator=(const Event&) = delete;
  ~Event() { forget(); }
  void wait(const Device& device);

 private:
  friend class Buffer;
  void forget();
  cl_event event_ = nullptr;
};

class Kernel {
 public:
  Kernel(const Device& device, cl_program program, const char* name);
  Kernel(Kernel&& other) noexcept;
  Kernel& operator=(Kernel&&) = delete;
  ~Kernel();
  /// Enqueues it. `total` is rounded up to a multiple of `group`.
  template <class... Arguments>
  void operator()(std::size_t total, std::size_t group, const Arguments&... arguments) {
    cl_uint at = 0;
    (set(at++, arguments), ...);
    enqueue(total, group);
  }

 private:
  void set(cl_uint at, const Buffer& buffer);
  void set(cl_uint at, cl_int value);
  void set(cl_uint at, double value);
  void set(cl_uint at, float value);
  void set_bytes(cl_uint at, std::size_t size, const void* value);
  void enqueue(std::size_t total, std::size_t group);

  const Device* device_;
  cl_kernel kernel_ = nullptr;
  std::string name_;
};

}  // namespace sutura::opencl
