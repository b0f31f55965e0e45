// The file of a checkpoint: chunks with names and checksums (docs/concepts/state.md). Knows no
// simulation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace sutura {

struct Chunk {
  std::string name;
  std::vector<std::byte> data;
  bool operator==(const Chunk&) const = default;
};

/// The chunks as bytes of version `checkpoint_version`.
std::vector<std::byte> pack_chunks(const std::vector<Chunk>& chunks);
/// The chunks back. What is wrong with the bytes, in a sentence, or empty; every changed, missing
/// or added byte is found.
std::string unpack_chunks(std::span<const std::byte> bytes, std::vector<Chunk>& chunks);

inline constexpr std::uint32_t checkpoint_version = 1;

/// Writes under a temporary name beside `file`, waits until it is on the disk and renames it: at
/// any time `file` is the old one or the new one, whole. An error sentence or empty.
std::string replace_file(const std::filesystem::path& file, std::span<const std::byte> bytes);
/// An error sentence or empty.
std::string read_file(const std::filesystem::path& file, std::vector<std::byte>& bytes);

/// The checksum of zip and Ethernet (CRC-32, reflected, polynomial 0xEDB88320), going on from
/// `before`.
std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t before = 0);

}  // namespace sutura
