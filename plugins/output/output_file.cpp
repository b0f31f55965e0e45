#include "output_file.h"

#include <cerrno>
#include <cstring>
#include <system_error>

namespace sutura::output {

std::string OutputFile::open(const std::filesystem::path& file) {
  path_ = file;
  end_ = 0;
  file_.reset();
  std::error_code error;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), error);
  if (error) return "cannot make the folder of " + path_.string() + ": " + error.message();
  errno = 0;
  file_.reset(std::fopen(file.c_str(), "wb"));
  return file_ ? std::string() : failure();
}

std::string OutputFile::resume(const std::filesystem::path& file, std::int64_t end) {
  path_ = file;
  end_ = end;
  file_.reset();
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) return "cannot go on with " + path_.string() + ": " + error.message();
  if (size < static_cast<std::uintmax_t>(end))
    return "cannot go on with " + path_.string() + ": it has " + std::to_string(size) +
           " bytes, and had " + std::to_string(end) + " when the state was saved";
  std::filesystem::resize_file(file, static_cast<std::uintmax_t>(end), error);
  if (error) return "cannot cut " + path_.string() + ": " + error.message();
  errno = 0;
  file_.reset(std::fopen(file.c_str(), "r+b"));
  return file_ ? std::string() : failure();
}

std::string OutputFile::append(std::string_view text) {
  if (std::string error = write(text); !error.empty()) return error;
  end_ += static_cast<std::int64_t>(text.size());
  return {};
}

std::string OutputFile::tail(std::string_view text) {
  return write(text);
}

std::string OutputFile::write(std::string_view text) {
  if (!file_) return path_.string() + " is not open";
  errno = 0;
  const bool ok = std::fseek(file_.get(), end_, SEEK_SET) == 0 &&
                  std::fwrite(text.data(), 1, text.size(), file_.get()) == text.size() &&
                  std::fflush(file_.get()) == 0;
  return ok ? std::string() : failure();
}

std::string OutputFile::close() {
  if (!file_) return {};
  errno = 0;
  return std::fclose(file_.release()) == 0 ? std::string() : failure();
}

std::string OutputFile::failure() const {
  return "cannot write " + path_.string() + ": " +
         (errno != 0 ? std::strerror(errno) : "unknown reason");
}

std::string write_file(const std::filesystem::path& file, std::string_view text) {
  OutputFile out;
  if (std::string error = out.open(file); !error.empty()) return error;
  if (std::string error = out.append(text); !error.empty()) return error;
  return out.close();
}

}  // namespace sutura::output
