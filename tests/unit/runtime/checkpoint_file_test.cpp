// The file of a state: no damage passes, and a program that is killed while it writes leaves a
// whole file.
#include "runtime/checkpoint_file.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <random>

namespace sutura {
namespace {

namespace fs = std::filesystem;

std::vector<std::byte> random_bytes(std::size_t size, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::byte> out(size);
  for (std::byte& b : out) b = static_cast<std::byte>(random());
  return out;
}

std::vector<Chunk> some_chunks() {
  return {{"identity", random_bytes(60, 1)},
          {"/skin/tissue", random_bytes(3000, 2)},
          {"/empty", {}},
          {"/suture", random_bytes(1000, 3)}};
}

class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("sutura_state_" + std::to_string(::getpid()))) {
    fs::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

TEST(CheckpointFile, ChecksumIsThatOfTheStandard) {
  const std::string text = "123456789";
  EXPECT_EQ(crc32(std::as_bytes(std::span(text))), 0xCBF43926u);  // the check value of CRC-32
}

TEST(CheckpointFile, GivesBackTheChunks) {
  std::vector<Chunk> back;
  EXPECT_EQ(unpack_chunks(pack_chunks(some_chunks()), back), "");
  EXPECT_TRUE(back == some_chunks());
  EXPECT_EQ(unpack_chunks(pack_chunks({}), back), "");
  EXPECT_TRUE(back.empty());
}

TEST(CheckpointFile, TenThousandFlippedBitsAreAllFound) {
  const std::vector<std::byte> good = pack_chunks(some_chunks());
  std::mt19937_64 random(7);
  std::vector<Chunk> back;
  for (int i = 0; i < 10000; ++i) {
    std::vector<std::byte> bad = good;
    // Every bit of the first bytes, where the structure is, then anywhere.
    const std::size_t bit = i < 4096 ? static_cast<std::size_t>(i) : random() % (8 * bad.size());
    bad[bit / 8] ^= std::byte{1} << (bit % 8);
    EXPECT_NE(unpack_chunks(bad, back), "") << "bit " << bit;
  }
}

TEST(CheckpointFile, EveryTruncationAndEveryAdditionIsFound) {
  const std::vector<std::byte> good = pack_chunks(some_chunks());
  std::vector<Chunk> back;
  for (std::size_t n = 0; n < good.size(); ++n)
    EXPECT_NE(unpack_chunks(std::span(good).first(n), back), "") << n;
  std::vector<std::byte> longer = good;
  longer.push_back(std::byte{0});
  EXPECT_EQ(unpack_chunks(longer, back), "damaged: it goes on behind its end");
}

TEST(CheckpointFile, AnotherVersionIsNamed) {
  std::vector<std::byte> bytes = pack_chunks(some_chunks());
  bytes[8] = std::byte{99};
  const std::uint32_t sum = crc32(std::span(bytes).first(16));
  std::memcpy(bytes.data() + 16, &sum, sizeof sum);
  std::vector<Chunk> back;
  EXPECT_EQ(unpack_chunks(bytes, back), "a checkpoint of version 99; this program reads 1");
}

TEST(CheckpointFile, SaysWhatCannotBeWrittenOrRead) {
  const Folder folder;
  std::vector<std::byte> bytes;
  EXPECT_NE(read_file(folder.path() / "none", bytes).find("No such file"), std::string::npos);
  EXPECT_NE(read_file(folder.path(), bytes).find("not a file"), std::string::npos);
  std::ofstream(folder.path() / "plain") << "x";
  EXPECT_NE(replace_file(folder.path() / "plain" / "state", bytes), "");
}

// A device would be replaced by a file, and a pipe waited for.
TEST(CheckpointFile, OnlyFilesAreReadAndReplaced) {
  const Folder folder;
  std::vector<std::byte> bytes{std::byte{1}};
  const fs::path pipe = folder.path() / "pipe", link = folder.path() / "link";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0666), 0);
  fs::create_symlink(pipe, link);
  for (const fs::path& file : {pipe, link, folder.path(), folder.path() / "", fs::path()}) {
    EXPECT_NE(replace_file(file, bytes).find("not a file"), std::string::npos) << file;
    EXPECT_FALSE(fs::exists(file.string() + ".part")) << file;
  }
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_NE(read_file(pipe, bytes).find("not a file"), std::string::npos);
}

// A child writes states of two megabytes one after the other until it is killed, at a moment that
// is another one every time. Whatever the moment, a whole state is there.
TEST(CheckpointFile, KilledWhileWritingItIsAlwaysWhole) {
  const Folder folder;
  const fs::path file = folder.path() / "checkpoint.sutura";
  std::vector<std::vector<std::byte>> states;
  for (unsigned i = 0; i < 3; ++i) states.push_back(pack_chunks({{"a", random_bytes(2000000, i)}}));
  ASSERT_EQ(replace_file(file, states[0]), "");
  std::mt19937 random(1);
  int interrupted = 0;
  for (int kill = 0; kill < 200; ++kill) {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      for (std::size_t i = 1;; i = (i + 1) % states.size())
        if (!replace_file(file, states[i]).empty()) ::_exit(1);
    }
    ::usleep(static_cast<useconds_t>(random() % 20000));
    ::kill(child, SIGKILL);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFSIGNALED(status)) << "the child could not write";
    std::error_code none;
    interrupted += fs::exists(file.string() + ".part", none);
    std::vector<std::byte> found;
    ASSERT_EQ(read_file(file, found), "");
    std::vector<Chunk> back;
    ASSERT_EQ(unpack_chunks(found, back), "") << "kill " << kill;
    EXPECT_TRUE(found == states[0] || found == states[1] || found == states[2]);
  }
  EXPECT_GT(interrupted, 20) << "too few of the kills came while a file was being written";
}

}  // namespace
}  // namespace sutura
