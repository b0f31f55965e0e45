#include "scene/plugin_file.h"

#include <elf.h>

#include <cstdint>
#include <cstring>
#include <fstream>

namespace sutura {

namespace {

template <class T>
bool read_at(std::ifstream& in, std::uint64_t offset, T& out) {
  in.seekg(static_cast<std::streamoff>(offset));
  return static_cast<bool>(in.read(reinterpret_cast<char*>(&out), sizeof out));
}

}  // namespace

std::string check_plugin_file(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return "is not a file";
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  std::ifstream in(file, std::ios::binary);
  if (error || !in) return "cannot be read";
  const std::string cut_short = "is cut short: it has " + std::to_string(size) + " bytes of ";
  Elf64_Ehdr header;
  if (!read_at(in, 0, header)) return "is no shared library";
  if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 || header.e_ident[EI_CLASS] != ELFCLASS64 ||
      header.e_type != ET_DYN || header.e_phentsize != sizeof(Elf64_Phdr))
    return "is no shared library of this kind of machine";
  for (unsigned i = 0; i < header.e_phnum; ++i) {
    Elf64_Phdr segment;
    const std::uint64_t at = header.e_phoff + std::uint64_t{i} * sizeof segment;
    if (!read_at(in, at, segment)) return cut_short + "at least " + std::to_string(at);
    const std::uint64_t end = segment.p_offset + segment.p_filesz;
    if (segment.p_type == PT_LOAD && (end < segment.p_offset || end > size))
      return cut_short + std::to_string(end);
  }
  return {};
}

}  // namespace sutura
