#include "runtime/checkpoint_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace sutura {
namespace {

constexpr std::string_view magic = "SUTURAck";

/// The beginning of the file. Its checksum is over the three before it.
struct FileHead {
  char magic[8];
  std::uint32_t version, chunks;
};
static_assert(sizeof(FileHead) == 16);

/// The beginning of each chunk. Its checksum is over this, the name and the data.
struct ChunkHead {
  std::uint64_t data, name;  // bytes
};
static_assert(sizeof(ChunkHead) == 16);

constexpr std::array<std::uint32_t, 256> crc_table = [] {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t c = i;
    for (int bit = 0; bit < 8; ++bit) c = (c >> 1) ^ (c & 1 ? 0xEDB88320u : 0u);
    table[i] = c;
  }
  return table;
}();

std::span<const std::byte> bytes_of(const auto& value) {
  return std::as_bytes(std::span(&value, 1));
}
std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

/// Takes from the front, never more than there is.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : left_(bytes) {}
  bool read(auto& value) {
    const auto from = take(sizeof value);
    if (from.size() == sizeof value) std::memcpy(&value, from.data(), sizeof value);
    return from.size() == sizeof value;
  }
  /// Empty if there is less.
  std::span<const std::byte> take(std::uint64_t count) {
    if (count > left_.size()) return {};
    const auto front = left_.first(count);
    left_ = left_.subspan(count);
    return front;
  }
  std::size_t left() const { return left_.size(); }

 private:
  std::span<const std::byte> left_;
};

std::string failure(const std::string& what, const std::filesystem::path& file) {
  return what + " " + file.string() + ": " + std::strerror(errno);
}

/// An open file that is closed on every way out.
class Descriptor {
 public:
  Descriptor(const std::filesystem::path& file, int flags)
      : number_(::open(file.c_str(), flags | O_CLOEXEC, 0666)) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  bool ok() const { return number_ >= 0; }
  int number() const { return number_; }
  bool write(std::span<const std::byte> bytes) const {
    while (!bytes.empty()) {
      const ssize_t n = ::write(number_, bytes.data(), bytes.size());
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) return false;
      bytes = bytes.subspan(static_cast<std::size_t>(n));
    }
    return true;
  }

 private:
  int number_;
};

}  // namespace

std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t before) {
  std::uint32_t c = ~before;
  for (const std::byte b : bytes)
    c = crc_table[(c ^ std::to_integer<std::uint32_t>(b)) & 0xFF] ^ (c >> 8);
  return ~c;
}

std::vector<std::byte> pack_chunks(const std::vector<Chunk>& chunks) {
  std::vector<std::byte> out;
  const auto append = [&out](std::span<const std::byte> b) {
    const std::size_t end = out.size();
    out.resize(end + b.size());
    if (!b.empty()) std::memcpy(out.data() + end, b.data(), b.size());
  };
  FileHead head{{}, checkpoint_version, static_cast<std::uint32_t>(chunks.size())};
  std::memcpy(head.magic, magic.data(), sizeof head.magic);
  append(bytes_of(head));
  append(bytes_of(crc32(bytes_of(head))));
  for (const Chunk& chunk : chunks) {
    const ChunkHead c{chunk.data.size(), chunk.name.size()};
    append(bytes_of(c));
    append(bytes_of(crc32(chunk.data, crc32(bytes_of(chunk.name), crc32(bytes_of(c))))));
    append(bytes_of(chunk.name));
    append(chunk.data);
  }
  return out;
}

std::string unpack_chunks(std::span<const std::byte> bytes, std::vector<Chunk>& chunks) {
  chunks.clear();
  Reader reader(bytes);
  FileHead head;
  std::uint32_t sum = 0;
  if (!reader.read(head) || std::string_view(head.magic, sizeof head.magic) != magic)
    return "not a checkpoint";
  if (!reader.read(sum) || sum != crc32(bytes_of(head)))
    return "damaged: the checksum of its head is wrong";
  if (head.version != checkpoint_version)
    return "a checkpoint of version " + std::to_string(head.version) + "; this program reads " +
           std::to_string(checkpoint_version);
  for (std::uint32_t i = 0; i < head.chunks; ++i) {
    ChunkHead c;
    if (!reader.read(c) || !reader.read(sum)) return "cut off";
    if (c.name > reader.left() || c.data > reader.left() - c.name)
      return "damaged or cut off: part " + std::to_string(i + 1) + " ends behind its end";
    const auto name = reader.take(c.name), data = reader.take(c.data);
    if (sum != crc32(data, crc32(name, crc32(bytes_of(c)))))
      return "damaged: the checksum of part " + std::to_string(i + 1) + " is wrong";
    chunks.push_back({std::string(reinterpret_cast<const char*>(name.data()), name.size()),
                      {data.begin(), data.end()}});
  }
  if (reader.left() > 0) return "damaged: it goes on behind its end";
  return {};
}

std::string replace_file(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  std::error_code error;
  // What is replaced must be a file: a device, say /dev/null, would be gone.
  const bool exists = std::filesystem::exists(file, error);
  if (!file.has_filename() || (exists && !std::filesystem::is_regular_file(file, error)))
    return "cannot write '" + file.string() + "': it is not a file";
  error.clear();
  std::filesystem::create_directories(folder, error);
  if (error) return "cannot make the folder of " + file.string() + ": " + error.message();
  const std::filesystem::path temporary = file.string() + ".part";
  errno = 0;
  const auto written = [&] {
    const Descriptor out(temporary, O_WRONLY | O_CREAT | O_TRUNC);
    return out.ok() && out.write(bytes) && ::fsync(out.number()) == 0;
  };
  if (!written() || ::rename(temporary.c_str(), file.c_str()) != 0) {
    std::string problem = failure("cannot write", file);
    ::unlink(temporary.c_str());
    return problem;
  }
  // The new name is on the disk only when the folder is.
  const Descriptor entry(folder, O_RDONLY | O_DIRECTORY);
  if (!entry.ok() || ::fsync(entry.number()) != 0) return failure("cannot write", file);
  return {};
}

std::string read_file(const std::filesystem::path& file, std::vector<std::byte>& bytes) {
  bytes.clear();
  errno = 0;
  const Descriptor in(file, O_RDONLY | O_NONBLOCK);  // a pipe would be waited for
  struct stat status {};
  if (!in.ok() || ::fstat(in.number(), &status) != 0) return failure("cannot read", file);
  if (!S_ISREG(status.st_mode)) return "cannot read " + file.string() + ": it is not a file";
  bytes.resize(static_cast<std::size_t>(status.st_size));
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = ::read(in.number(), bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return failure("cannot read", file);
    if (n == 0) break;
    done += static_cast<std::size_t>(n);
  }
  bytes.resize(done);
  return {};
}

}  // namespace sutura
