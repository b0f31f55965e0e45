#include "scene/nearest_file.h"

#include <algorithm>
#include <vector>

#include "sutura/diagnostics.h"

namespace sutura {

namespace {

namespace fs = std::filesystem;

constexpr int most_entries = 2000;  // of one folder: a mistake may point anywhere

/// Names in a folder, sorted, so that the answer does not depend on the file system.
std::vector<std::string> entries(const fs::path& folder, bool folders) {
  std::vector<std::string> out;
  std::error_code ignored;
  int count = 0;
  for (fs::directory_iterator i(folder, ignored), end; i != end && count < most_entries;
       i.increment(ignored), ++count) {
    const std::string name = i->path().filename().string();
    if (!name.starts_with('.') && i->is_directory(ignored) == folders) out.push_back(name);
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// The nearest file in `folder`; without one that is spelt like it, the one of the same stem.
std::string nearest_in(const fs::path& folder, const fs::path& name) {
  const std::vector<std::string> files = entries(folder, false);
  std::vector<std::string> same_kind;
  for (const std::string& f : files)
    if (fs::path(f).extension() == name.extension()) same_kind.push_back(f);
  const std::string near = nearest_name(name.string(), same_kind);
  if (!near.empty()) return near;
  for (const std::string& f : files)
    if (fs::path(f).stem() == name.stem()) return f;
  return nearest_name(name.string(), files);
}

/// The only file of that kind in `folder`: what else can have been meant?
std::string alone_in(const fs::path& folder, const fs::path& name) {
  std::string alone;
  for (const std::string& f : entries(folder, false)) {
    if (!name.has_extension() || fs::path(f).extension() != name.extension()) continue;
    if (!alone.empty()) return {};
    alone = f;
  }
  return alone;
}

/// The folder as written if it exists, else with each step that does not exist spelt as the nearest
/// that does.
fs::path nearest_folder(const fs::path& directory, const fs::path& folder) {
  fs::path out = folder.is_absolute() ? folder.root_path() : fs::path();
  for (const fs::path& step : folder.relative_path()) {
    std::error_code ignored;
    if (fs::is_directory(directory / out / step, ignored)) {
      out /= step;
      continue;
    }
    const std::string near = nearest_name(step.string(), entries(directory / out, true));
    if (near.empty()) return out;
    out /= near;
  }
  return out;
}

}  // namespace

std::string nearest_file(const fs::path& directory, const std::string& file) {
  const fs::path here = directory.empty() ? fs::path(".") : directory;
  const fs::path name = fs::path(file).filename();
  if (name.empty()) return {};
  std::vector<fs::path> folders{nearest_folder(here, fs::path(file).parent_path())};
  for (const fs::path& base : {folders.front(), fs::path(), fs::path("..")})
    for (const std::string& below : entries(here / base, true)) folders.push_back(base / below);
  folders.emplace_back();
  folders.emplace_back("..");
  for (const fs::path& folder : folders) {
    std::error_code ignored;
    if (fs::is_regular_file(here / folder / name, ignored)) return (folder / name).string();
  }
  for (const fs::path& folder : folders)
    if (const std::string near = nearest_in(here / folder, name); !near.empty())
      return (folder / near).string();
  const std::string alone = alone_in(here / folders.front(), name);
  return alone.empty() ? alone : (folders.front() / alone).string();
}

}  // namespace sutura
