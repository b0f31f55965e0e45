// A reader of .vtu arrays that shares nothing with the writer: base64 by table look-up, arrays by
// the text between their tags.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace sutura::output {

struct VtuArray {
  std::string type;
  std::string bytes;

  template <class T>
  std::vector<T> numbers() const {
    const std::map<std::string, std::size_t> sizes{
        {"Float64", 8}, {"Float32", 4}, {"Int32", 4}, {"UInt8", 1}};
    if (sizes.at(type) != sizeof(T)) throw std::runtime_error("array holds " + type);
    std::vector<T> out(bytes.size() / sizeof(T));
    std::memcpy(out.data(), bytes.data(), out.size() * sizeof(T));
    return out;
  }
};

inline std::string decode_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  int bits = 0;
  unsigned buffer = 0;
  for (const char c : text) {
    if (c == '=') break;
    const auto value = digits.find(c);
    if (value == std::string::npos) throw std::runtime_error("not base64");
    buffer = buffer << 6 | static_cast<unsigned>(value);
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      out += static_cast<char>(buffer >> bits & 255);
    }
  }
  return out;
}

inline std::string attribute(const std::string& tag, const std::string& name) {
  const auto at = tag.find(" " + name + "=\"");
  if (at == std::string::npos) return {};
  const auto from = at + name.size() + 3;
  return tag.substr(from, tag.find('"', from) - from);
}

/// Blocks of zlib after a header of 64 bit numbers: blocks, size of each, of the last, compressed
/// sizes. Header and blocks are encoded apart.
inline std::string decompressed(const std::string& text) {
  const auto number = [](const std::string& bytes, std::size_t i) {
    std::uint64_t value = 0;
    if (bytes.size() < 8 * (i + 1)) throw std::runtime_error("the header is too short");
    std::memcpy(&value, bytes.data() + 8 * i, 8);
    return value;
  };
  const std::uint64_t blocks = number(decode_base64(text.substr(0, 12)), 0);
  const std::size_t header_digits = (8 * (3 + blocks) + 2) / 3 * 4;
  const std::string header = decode_base64(text.substr(0, header_digits));
  const std::string packed = decode_base64(text.substr(header_digits));
  std::string out;
  std::size_t at = 0;
  for (std::size_t i = 0; i < blocks; ++i) {
    const std::uint64_t last = number(header, 2);
    uLongf size = i + 1 == blocks && last > 0 ? last : number(header, 1);
    std::string block(size, '\0');
    const auto length = number(header, 3 + i);
    if (uncompress(reinterpret_cast<Bytef*>(block.data()), &size,
                   reinterpret_cast<const Bytef*>(packed.data() + at), length) != Z_OK)
      throw std::runtime_error("not zlib");
    out += block;
    at += length;
  }
  if (at != packed.size()) throw std::runtime_error("bytes left over");
  return out;
}

/// Every DataArray by its Name (as written, not unescaped).
inline std::map<std::string, VtuArray> read_vtu_arrays(const std::string& text) {
  std::map<std::string, VtuArray> arrays;
  for (auto at = text.find("<DataArray"); at != std::string::npos;
       at = text.find("<DataArray", at + 1)) {
    const auto end_of_tag = text.find('>', at);
    const std::string tag = text.substr(at, end_of_tag - at);
    const auto end = text.find("</DataArray>", end_of_tag);
    arrays[attribute(tag, "Name")] = {
        attribute(tag, "type"), decompressed(text.substr(end_of_tag + 1, end - end_of_tag - 1))};
  }
  return arrays;
}

}  // namespace sutura::output
