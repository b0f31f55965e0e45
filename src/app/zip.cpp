#include "app/zip.h"

#include <zlib.h>

#include <limits>

namespace sutura::app {
namespace {

std::string little(std::uint64_t value, int bytes) {
  std::string out;
  for (int i = 0; i < bytes; ++i) out += static_cast<char>(value >> (8 * i) & 0xff);
  return out;
}

/// Without the header that zlib puts in front. Empty if there is not enough memory.
std::string deflated(std::string_view data) {
  constexpr int window = 15, memory = 8;
  z_stream z{};
  if (deflateInit2(&z, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -window, memory, Z_DEFAULT_STRATEGY) !=
      Z_OK)
    return {};
  std::string out(deflateBound(&z, data.size()), '\0');
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(data.data()));
  z.avail_in = static_cast<uInt>(data.size());
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  const int end = deflate(&z, Z_FINISH);
  out.resize(out.size() - z.avail_out);
  deflateEnd(&z);
  return end == Z_STREAM_END ? out : std::string();
}

/// What the header of a file and the list of files have in common: version 2.0, deflate, the date
/// 1 January 1980, so that the same files make the same bytes.
std::string common(std::uint32_t checksum, std::uint32_t packed, std::uint32_t size,
                   std::size_t name) {
  return little(20, 2) + little(0, 2) + little(8, 2) + little(0, 2) + little(0x21, 2) +
         little(checksum, 4) + little(packed, 4) + little(size, 4) + little(name, 2) + little(0, 2);
}

}  // namespace

void Zip::add(const std::string& name, std::string_view data) {
  const std::string packed = deflated(data);
  const auto offset = static_cast<std::uint64_t>(out_.tellp());
  fits_ = fits_ && !packed.empty() && name.size() < 0xffff && entries_.size() < 0xffff &&
          offset + packed.size() + data.size() < std::numeric_limits<std::uint32_t>::max();
  if (!fits_) return;
  const auto checksum = static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(data.data()), data.size()));
  entries_.push_back({name, checksum, static_cast<std::uint32_t>(packed.size()),
                      static_cast<std::uint32_t>(data.size()), static_cast<std::uint32_t>(offset)});
  const Entry& e = entries_.back();
  out_ << little(0x04034b50, 4) << common(e.checksum, e.packed, e.size, name.size()) << name
       << packed;
}

bool Zip::finish() {
  const auto begin = static_cast<std::uint64_t>(out_.tellp());
  for (const Entry& e : entries_)
    out_ << little(0x02014b50, 4) << little(20, 2)
         << common(e.checksum, e.packed, e.size, e.name.size()) << little(0, 2) << little(0, 2)
         << little(0, 2) << little(0, 4) << little(e.offset, 4) << e.name;
  const auto end = static_cast<std::uint64_t>(out_.tellp());
  out_ << little(0x06054b50, 4) << little(0, 4) << little(entries_.size(), 2)
       << little(entries_.size(), 2) << little(end - begin, 4) << little(begin, 4) << little(0, 2);
  return fits_ && static_cast<bool>(out_);
}

}  // namespace sutura::app
