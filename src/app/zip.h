// A zip file, written from the beginning to its end (APPNOTE.TXT of PKWARE, without extensions:
// files and the whole below 4 GB).
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace sutura::app {

class Zip {
 public:
  explicit Zip(const std::filesystem::path& file) : out_(file, std::ios::binary) {}
  void add(const std::string& name, std::string_view data);
  /// Writes the list of files. False if anything could not be written.
  bool finish();

 private:
  struct Entry {
    std::string name;
    std::uint32_t checksum, packed, size, offset;
  };
  std::ofstream out_;
  std::vector<Entry> entries_;
  bool fits_ = true;
};

}  // namespace sutura::app
