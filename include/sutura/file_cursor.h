// Walks over the bytes of a file: words, numbers and binary values, never past the end. Readers
// throw a FileProblem at the first fault and catch it before they return.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <string_view>

#include "sutura/text.h"
#include "sutura/types.h"

namespace sutura {

/// What is wrong with a file, and where.
struct FileProblem {
  int line = 0;  ///< 1-based; 0 if no line can be named
  std::string message;
};

class FileCursor {
 public:
  explicit FileCursor(std::string_view bytes) : bytes_(bytes) {}

  bool swap_bytes = false;  ///< binary values are of the other endianness

  std::size_t position() const { return position_; }
  std::size_t left() const { return bytes_.size() - position_; }
  int line() const { return line_; }

  [[noreturn]] void fail(const std::string& message) const { throw FileProblem{line_, message}; }
  [[noreturn]] void fail_binary(const std::string& message) const {
    throw FileProblem{line_, "byte " + std::to_string(position_) + ": " + message};
  }

  /// The next word without moving; empty at the end of the file.
  std::string_view peek() {
    skip_blanks();
    std::size_t end = position_;
    while (end < bytes_.size() && !is_blank(bytes_[end])) ++end;
    return bytes_.substr(position_, end - position_);
  }
  std::string_view word(const char* expected) {
    const std::string_view w = peek();
    if (w.empty()) fail(std::string("the file ends where ") + expected + " was expected");
    position_ += w.size();
    return w;
  }
  void keyword(std::string_view expected) {
    const std::string_view w = word(std::string(expected).c_str());
    if (w != expected)
      fail("found '" + shortened(w) + "', expected '" + std::string(expected) + "'");
  }
  template <class T>
  T integer(const char* what, T low, T high) {
    const std::string_view w = word(what);
    T value{};
    const auto [end, error] = std::from_chars(w.data(), w.data() + w.size(), value);
    if (error != std::errc{} || end != w.data() + w.size())
      fail("found '" + shortened(w) + "', expected " + what + " (a whole number)");
    check_range(value, what, low, high);
    return value;
  }
  Real real(const char* what) {
    const std::string_view w = word(what);
    Real value = 0;
    const auto [end, error] = std::from_chars(w.data(), w.data() + w.size(), value);
    if (error != std::errc{} || end != w.data() + w.size() || !std::isfinite(value))
      fail("found '" + shortened(w) + "', expected " + what + " (a finite number)");
    return value;
  }
  /// A count of things that need at least `bytes_each` more bytes of file.
  std::size_t count(const char* what, std::size_t bytes_each) {
    const auto n = integer<long long>(what, 0, std::numeric_limits<long long>::max());
    check_fits(static_cast<unsigned long long>(n), what, bytes_each);
    return static_cast<std::size_t>(n);
  }
  void check_fits(unsigned long long n, const char* what, std::size_t bytes_each) const {
    if (n > left() / std::max<std::size_t>(1, bytes_each))
      fail(std::string(what) + " is " + std::to_string(n) + ", but only " + std::to_string(left()) +
           " bytes of the file are left");
  }
  template <class T>
  void check_range(T value, const char* what, T low, T high) const {
    if (value < low || value > high) {
      std::string range = high == std::numeric_limits<T>::max()
                              ? "at least " + std::to_string(low)
                              : std::to_string(low) + " to " + std::to_string(high);
      fail(std::string(what) + " is " + std::to_string(value) + ", expected " + range);
    }
  }

  /// Up to the end of the line; the line break is consumed, not returned.
  std::string_view rest_of_line() {
    const std::size_t start = position_;
    const std::size_t end = std::min(bytes_.find('\n', start), bytes_.size());
    position_ = end;
    if (position_ < bytes_.size()) ++position_, ++line_;
    std::string_view text = bytes_.substr(start, end - start);
    if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
    return text;
  }
  /// Moves behind the next `text`; false (and no move) if there is none.
  bool skip_past(std::string_view text) {
    const std::size_t at = bytes_.find(text, position_);
    if (at == std::string_view::npos) return false;
    line_ += static_cast<int>(std::count(bytes_.begin() + static_cast<std::ptrdiff_t>(position_),
                                         bytes_.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
    position_ = at + text.size();
    return true;
  }

  template <class T>
  T binary(const char* what) {
    if (left() < sizeof(T))
      fail_binary(std::string("the file ends where ") + what + " was expected");
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes_.data() + position_, sizeof(T));
    if (swap_bytes) std::reverse(raw.begin(), raw.end());
    position_ += sizeof(T);
    return std::bit_cast<T>(raw);
  }
  Real binary_real(const char* what) {
    const double value = binary<double>(what);
    if (!std::isfinite(value)) {
      position_ -= sizeof(double);
      fail_binary(std::string(what) + " is not a finite number");
    }
    return value;
  }
  void skip_bytes(std::size_t n, const char* what) {
    if (left() < n) fail_binary(std::string("the file ends inside ") + what);
    position_ += n;
  }

  static std::string shortened(std::string_view w) {
    std::string out = sutura::shortened(w, 24);
    for (char& c : out)
      if (!(c >= 32 && c < 127)) c = '?';
    return out;
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; }
  void skip_blanks() {
    while (position_ < bytes_.size() && is_blank(bytes_[position_])) {
      if (bytes_[position_] == '\n') ++line_;
      ++position_;
    }
  }

  std::string_view bytes_;
  std::size_t position_ = 0;
  int line_ = 1;
};

/// The bytes of a regular file of at most `limit` bytes; anything else is thrown as a FileProblem.
inline std::string read_bytes(const std::filesystem::path& file, std::uintmax_t limit) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) throw FileProblem{0, "no such file"};
  if (!std::filesystem::is_regular_file(file, error)) throw FileProblem{0, "not a regular file"};
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) throw FileProblem{0, "cannot be read: " + error.message()};
  if (size > limit)
    throw FileProblem{0, "the file has " + std::to_string(size) +
                             " bytes, more than the limit of " + std::to_string(limit)};
  std::string bytes(static_cast<std::size_t>(size), '\0');
  std::ifstream in(file, std::ios::binary);
  if (!in.read(bytes.data(), static_cast<std::streamsize>(size)))
    throw FileProblem{0, "cannot be read"};
  return bytes;
}

}  // namespace sutura
