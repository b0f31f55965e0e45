#include "sutura/archive.h"

#include <cstring>

#include "sutura/body.h"

namespace sutura {
namespace {

/// How every value begins; then come its name and its numbers, as they lie in memory.
struct Head {
  char type = 0;
  std::uint8_t size = 0;  // bytes of one number
  std::uint16_t name = 0;
  std::uint64_t rows = 0, columns = 0;
};

}  // namespace

void Archive::fail(std::string sentence) {
  if (problem_.empty()) problem_ = std::move(sentence);
}

bool Archive::read(void* to, std::size_t size) {
  if (!ok()) return false;
  if (size > saved_.size() - at_) {
    fail("the state ends too early");
    return false;
  }
  if (size > 0) std::memcpy(to, saved_.data() + at_, size);
  at_ += size;
  return true;
}

bool Archive::begin(std::string_view name, char type, std::size_t size, Index& rows,
                    Index& columns) {
  if (!restoring_) {
    const Head head{type, static_cast<std::uint8_t>(size), static_cast<std::uint16_t>(name.size()),
                    static_cast<std::uint64_t>(rows), static_cast<std::uint64_t>(columns)};
    for (const auto& [from, count] : {std::pair<const void*, std::size_t>(&head.type, 1),
                                      {&head.size, 1},
                                      {&head.name, 2},
                                      {&head.rows, 8},
                                      {&head.columns, 8},
                                      {name.data(), name.size()}}) {
      const auto* bytes = static_cast<const std::byte*>(from);
      bytes_.insert(bytes_.end(), bytes, bytes + count);
    }
    return true;
  }
  Head head;
  if (!read(&head.type, 1) || !read(&head.size, 1) || !read(&head.name, 2) ||
      !read(&head.rows, 8) || !read(&head.columns, 8))
    return false;
  std::string found(std::min<std::size_t>(head.name, saved_.size() - at_), ' ');
  if (!read(found.data(), head.name)) return false;
  if (found != name || head.type != type || head.size != size) {
    fail("expected '" + std::string(name) + "', found '" + found + "'" +
         (found == name ? " of another type" : ""));
    return false;
  }
  const std::uint64_t left = saved_.size() - at_;
  constexpr std::uint64_t most = std::uint64_t{1} << 40;  // of rows without columns, or the reverse
  if (head.rows > most || head.columns > most ||
      (head.columns > 0 && head.rows > left / size / head.columns)) {
    fail("'" + found + "' is larger than what is left");
    return false;
  }
  rows = static_cast<Index>(head.rows);
  columns = static_cast<Index>(head.columns);
  return true;
}

void Archive::copy(void* data, std::size_t size) {
  if (restoring_) {
    read(data, size);
    return;
  }
  const auto* from = static_cast<const std::byte*>(data);
  if (size > 0) bytes_.insert(bytes_.end(), from, from + size);
}

void Archive::fixed(std::string_view name, char type, std::size_t size, Index rows, Index columns,
                    void* data) {
  const Index expected_rows = rows, expected_columns = columns;
  if (!begin(name, type, size, rows, columns)) return;
  if (rows != expected_rows || columns != expected_columns)
    return fail("'" + std::string(name) + "' has the wrong shape");
  copy(data, size * static_cast<std::size_t>(rows * columns));
}

void Archive::operator()(std::string_view name, std::string& text) {
  Index length = static_cast<Index>(text.size()), columns = 1;
  if (!begin(name, 't', 1, length, columns)) return;
  if (restoring_) text.resize(static_cast<std::size_t>(length * columns));
  copy(text.data(), text.size());
}

void Archive::operator()(std::string_view name, Pose& pose) {
  (*this)(name, pose.position);
  (*this)(name, pose.rotation);
}

void Archive::operator()(std::string_view name, Wrench& wrench) {
  (*this)(name, wrench.force);
  (*this)(name, wrench.moment);
}

void Archive::operator()(std::string_view name, EmbeddedPoint& point) {
  (*this)(name, point.element);
  fixed(name, type_of<Real>(), sizeof(Real), static_cast<Index>(point.weights.size()), 1,
        point.weights.data());
}

}  // namespace sutura
