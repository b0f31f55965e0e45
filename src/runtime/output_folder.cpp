#include "runtime/output_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

namespace sutura {

namespace {

namespace fs = std::filesystem;

constexpr const char* list_name = ".sutura_files";
constexpr const char* list_head = "# What the last run wrote here; the next one removes it.";

bool matches(const std::string& name, const std::string& pattern) {
  const std::size_t star = pattern.find('*');
  if (star == std::string::npos) return name == pattern;
  const std::string before = pattern.substr(0, star), after = pattern.substr(star + 1);
  return name.size() >= before.size() + after.size() && name.starts_with(before) &&
         name.ends_with(after);
}

/// A list is text that anybody may have edited: nothing outside of the folder is touched.
bool stays_inside(const fs::path& path) {
  if (path.empty() || path.is_absolute()) return false;
  for (const fs::path& step : path)
    if (step == "..") return false;
  return true;
}

void remove_listed(const fs::path& folder, const fs::path& listed) {
  if (!stays_inside(listed)) return;
  const fs::path parent = folder / listed.parent_path();
  const std::string pattern = listed.filename().string();
  std::error_code ignored;
  // A link to elsewhere is not a folder of ours.
  for (fs::path step = parent; step != folder && step.has_relative_path();
       step = step.parent_path())
    if (fs::is_symlink(step, ignored)) return;
  std::vector<fs::path> found;
  for (fs::directory_iterator i(parent, ignored), end; i != end; i.increment(ignored))
    if (!i->is_directory(ignored) && matches(i->path().filename().string(), pattern))
      found.push_back(i->path());
  for (const fs::path& file : found) fs::remove(file, ignored);
  if (listed.has_parent_path()) fs::remove(parent, ignored);  // if it is empty now
}

}  // namespace

std::string OutputFolder::take(const fs::path& folder, const std::vector<std::string>& files,
                               Before before) {
  release();
  const fs::path here = folder.empty() ? fs::path(".") : folder;
  std::error_code error;
  fs::create_directories(here, error);
  if (error) return "cannot make the folder " + here.string() + ": " + error.message();
  const std::string list = (here / list_name).string();
  const auto failed = [&] {
    const std::string why = std::strerror(errno);
    release();
    return "cannot write " + list + ": " + why;
  };
  lock_ = ::open(list.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (lock_ < 0) return failed();
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return failed();
    release();
    return "another run is writing to " + here.string() + "; give this one another --output folder";
  }
  std::ifstream listed(list);
  std::string text = std::string(list_head) + '\n';
  for (std::string line; std::getline(listed, line);) {
    if (line.starts_with('#')) continue;
    if (before == Before::goes)
      remove_listed(here, line);
    else if (std::find(files.begin(), files.end(), line) == files.end())
      text += line + '\n';
  }
  for (const std::string& file : files) text += file + '\n';
  const auto size = static_cast<ssize_t>(text.size());
  if (::ftruncate(lock_, 0) != 0 || ::write(lock_, text.data(), text.size()) != size)
    return failed();
  return {};
}

void OutputFolder::release() {
  if (lock_ >= 0) ::close(lock_);
  lock_ = -1;
}

}  // namespace sutura
