// A file that is complete up to the last write even if the process dies: every write is flushed.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace sutura::output {

class OutputFile {
 public:
  /// Makes the folder if needed and empties the file. All functions return an error sentence that
  /// names the file, or an empty string.
  std::string open(const std::filesystem::path& file);
  /// Opens the file as it is, cut back to its first `end` bytes.
  std::string resume(const std::filesystem::path& file, std::int64_t end);
  std::string append(std::string_view text);
  /// Writes `text` where the last `append` ended; the next append or tail overwrites it.
  std::string tail(std::string_view text);
  std::string close();
  /// Bytes of the file, the tail left out.
  std::int64_t end() const { return end_; }

 private:
  struct Close {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };
  std::string write(std::string_view text);
  std::string failure() const;

  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Close> file_;
  std::int64_t end_ = 0;  ///< where the last append ended
};

/// The whole file at once.
std::string write_file(const std::filesystem::path& file, std::string_view text);

}  // namespace sutura::output
