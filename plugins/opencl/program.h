// A program of an OpenCL device and its kernels: how they are compiled and run.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "memory.h"
#include "precision.h"

namespace sutura::opencl {

class Kernel {
 public:
  /// `single`: what the program calls `real` is.
  Kernel(const Device& device, cl_program program, const std::string& name, bool single);
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;
  ~Kernel();
  /// Enqueues it. `total` is rounded up to a multiple of `group`. Numbers go as `real`.
  template <class... Arguments>
  void operator()(std::size_t total, std::size_t group, const Arguments&... arguments) {
    cl_uint at = 0;
    (set(at++, arguments), ...);
    enqueue(total, group);
  }

 private:
  void set(cl_uint at, const Buffer& buffer);
  void set(cl_uint at, const Numbers& numbers) { set(at, numbers.memory()); }
  void set(cl_uint at, cl_int value) { set_bytes(at, sizeof(value), &value); }
  void set(cl_uint at, Real value);
  void set_bytes(cl_uint at, std::size_t size, const void* value);
  void enqueue(std::size_t total, std::size_t group);

  const Device& device_;
  cl_kernel kernel_ = nullptr;
  std::string name_;
  bool single_;
};

/// Compiled when the first of its kernels is asked for.
class Program {
 public:
  /// The source follows the definitions of the precision.
  Program(const Device& device, Precision precision, const std::string& source,
          std::string options = {});
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program();
  /// Throws DeviceError: it does not compile (with the log), or has no such kernel.
  Kernel& operator[](std::string_view kernel);

 private:
  const Device& device_;
  bool single_;
  std::string source_, options_;
  cl_program program_ = nullptr;
  std::map<std::string, Kernel, std::less<>> kernels_;
};

}  // namespace sutura::opencl
