// A zip file, written from the beginning to its end (APPNOTE.TXT of PKWARE, without extensions:
// files and the whole below 4 GB).
#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

namespace sutura::app {

class Zip {
 public:
  explicit Zip(std::ostream& out) : out_(out) {}
  void add(const std::string& name, std::string_view data);
  /// Writes the list of files. False if they do not fit, or the stream has failed.
  bool finish();

 private:
  struct Entry {
    std::string name;
    std::uint32_t checksum, packed, size, offset;
  };
  std::ostream& out_;
  std::vector<Entry> entries_;
  bool fits_ = true;
};

}  // namespace sutura::app
