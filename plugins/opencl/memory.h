// Memory of an OpenCL device.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "device.h"

namespace sutura::opencl {

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

/// Numbers on the device, in single or double precision; those of the host are double.
class Numbers {
 public:
  /// `size` of a number there: 4 or 8 bytes.
  Numbers(const Device& device, std::size_t size) : memory_(device), size_(size) {}
  /// Room for so many; what was in it is gone if it grows.
  void reserve(std::size_t count) { memory_.reserve(count * size_); }
  /// Neither `from` nor these may be written again until something is read.
  void write(std::span<const Real> from);
  void write(const Eigen::Ref<const VecX>& from) { write(std::span(from.data(), count(from))); }
  /// Likewise, into what it has room for, from this number on.
  void write_at(std::size_t first, std::span<const Real> from);
  /// Waits, as Buffer::read does.
  void read(std::span<Real> to);
  void read(Eigen::Ref<VecX> to) { read(std::span(to.data(), count(to))); }
  const Buffer& memory() const { return memory_; }

 private:
  static std::size_t count(const Eigen::Ref<const VecX>& v) {
    return static_cast<std::size_t>(v.size());
  }
  /// As they are on the device.
  const void* rounded(std::span<const Real> from);

  Buffer memory_;
  std::size_t size_;
  std::vector<float> rounded_;
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

}  // namespace sutura::opencl
