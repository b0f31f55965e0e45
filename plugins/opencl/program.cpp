#include "program.h"

#include <utility>

namespace sutura::opencl {

Kernel::Kernel(const Device& device, cl_program program, const std::string& name, bool single)
    : device_(device), name_(name), single_(single) {
  cl_int code = CL_SUCCESS;
  kernel_ = clCreateKernel(program, name.c_str(), &code);
  device_.check(code, "making the kernel", name_);
}

Kernel::~Kernel() {
  clReleaseKernel(kernel_);
}

void Kernel::set_bytes(cl_uint at, std::size_t size, const void* value) {
  device_.check(clSetKernelArg(kernel_, at, size, value), "setting arguments of the kernel", name_);
}

void Kernel::set(cl_uint at, const Buffer& buffer) {
  const cl_mem memory = buffer.get();
  set_bytes(at, sizeof(memory), &memory);
}

void Kernel::set(cl_uint at, Real value) {
  if (!single_) return set_bytes(at, sizeof(value), &value);
  const auto rounded = static_cast<float>(value);
  set_bytes(at, sizeof(rounded), &rounded);
}

void Kernel::enqueue(std::size_t total, std::size_t group) {
  total = (total + group - 1) / group * group;
  if (total == 0) return;
  cl_event event = nullptr;
  device_.check(clEnqueueNDRangeKernel(device_.queue(), kernel_, 1, nullptr, &total, &group, 0,
                                       nullptr, device_.timed_ ? &event : nullptr),
                "running the kernel", name_);
  if (device_.timed_) device_.launches_.push_back({name_, event});
}

Program::Program(const Device& device, Precision precision, const std::string& source,
                 std::string options)
    : device_(device),
      single_(!has_double_sums(precision)),
      source_(definitions(precision) + source),
      options_(std::move(options)) {}

Program::~Program() {
  if (program_ != nullptr) clReleaseProgram(program_);
}

Kernel& Program::operator[](std::string_view kernel) {
  if (program_ == nullptr) program_ = device_.build(source_, options_);
  const auto known = kernels_.find(kernel);
  if (known != kernels_.end()) return known->second;
  const std::string name(kernel);
  return kernels_.try_emplace(name, device_, program_, name, single_).first->second;
}

}  // namespace sutura::opencl
