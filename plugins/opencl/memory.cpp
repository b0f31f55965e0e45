#include "memory.h"

#include <algorithm>
#include <utility>

namespace sutura::opencl {

Buffer::Buffer(Buffer&& other) noexcept
    : device_(other.device_),
      memory_(std::exchange(other.memory_, nullptr)),
      bytes_(std::exchange(other.bytes_, 0)) {}

Buffer::~Buffer() {
  if (memory_ != nullptr) clReleaseMemObject(memory_);
}

void Buffer::reserve(std::size_t bytes) {
  if (bytes <= bytes_) return;
  bytes = std::max(bytes, bytes_ + bytes_ / 2);
  if (memory_ != nullptr) clReleaseMemObject(memory_);
  bytes_ = 0;
  cl_int code = CL_SUCCESS;
  memory_ = clCreateBuffer(device_->context(), CL_MEM_READ_WRITE, bytes, nullptr, &code);
  if (code != CL_SUCCESS) device_->check(code, "asking for bytes:", std::to_string(bytes));
  bytes_ = bytes;
}

void Buffer::write(const void* data, std::size_t bytes) {
  reserve(std::max(bytes, std::size_t{16}));
  if (bytes == 0) return;
  device_->check(clEnqueueWriteBuffer(device_->queue(), memory_, CL_FALSE, 0, bytes, data, 0,
                                      nullptr, nullptr),
                 "writing to its memory");
}

void Buffer::write_at(std::size_t offset, const void* data, std::size_t bytes) {
  device_->check(clEnqueueWriteBuffer(device_->queue(), memory_, CL_FALSE, offset, bytes, data, 0,
                                      nullptr, nullptr),
                 "writing to its memory");
}

void Buffer::read(void* data, std::size_t bytes, bool wait) const {
  if (bytes == 0) return;
  device_->check(clEnqueueReadBuffer(device_->queue(), memory_, wait ? CL_TRUE : CL_FALSE, 0, bytes,
                                     data, 0, nullptr, nullptr),
                 "reading from its memory");
}

void Buffer::read_later(void* data, std::size_t bytes, Event& read) const {
  read.forget();
  device_->check(clEnqueueReadBuffer(device_->queue(), memory_, CL_FALSE, 0, bytes, data, 0,
                                     nullptr, &read.event_),
                 "reading from its memory");
}

const void* Numbers::rounded(std::span<const Real> from) {
  if (size_ == sizeof(Real)) return from.data();
  rounded_.assign(from.begin(), from.end());
  return rounded_.data();
}

void Numbers::write(std::span<const Real> from) {
  memory_.write(rounded(from), from.size() * size_);
}

void Numbers::write_at(std::size_t first, std::span<const Real> from) {
  memory_.write_at(first * size_, rounded(from), from.size() * size_);
}

void Numbers::read(std::span<Real> to) {
  if (size_ == sizeof(Real)) return memory_.read(to.data(), to.size_bytes());
  rounded_.resize(to.size());
  memory_.read(rounded_);
  std::ranges::copy(rounded_, to.begin());
}

Pinned::Pinned(const Device& device, std::size_t bytes) : device_(&device) {
  cl_int code = CL_SUCCESS;
  memory_ = clCreateBuffer(device.context(), CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, bytes,
                           nullptr, &code);
  if (code == CL_SUCCESS)
    data_ = clEnqueueMapBuffer(device.queue(), memory_, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0,
                               bytes, 0, nullptr, nullptr, &code);
  if (code != CL_SUCCESS && memory_ != nullptr) clReleaseMemObject(memory_);
  device.check(code, "asking for memory that both reach");
}

Pinned::~Pinned() {
  clEnqueueUnmapMemObject(device_->queue(), memory_, data_, 0, nullptr, nullptr);
  clReleaseMemObject(memory_);
}

void Event::wait(const Device& device) {
  if (event_ == nullptr) return;
  device.check(clFlush(device.queue()), "sending it what to do");
  device.check(clWaitForEvents(1, &event_), "waiting for it");
}

void Event::forget() {
  if (event_ != nullptr) clReleaseEvent(event_);
  event_ = nullptr;
}

}  // namespace sutura::opencl
