// The files of this repository, as text: what is tracked, by the look of the tree (no git needed).
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace sutura::house {

namespace fs = std::filesystem;

inline const fs::path root = SUTURA_SOURCE_DIR;

/// Build trees, results and caches, as in .gitignore.
inline bool ignored(const fs::path& p) {
  const std::string name = p.filename().string();
  return name == ".git" || name == "__pycache__" || name == ".venv" ||
         (p.parent_path() == root && (name == "build" || name == "out"));
}

/// Paths relative to the root, sorted; `extensions` empty: all.
inline std::vector<std::string> files(const std::set<std::string>& extensions = {},
                                      const std::string& under = "") {
  std::vector<std::string> out;
  if (!fs::exists(root / under)) return out;
  for (fs::recursive_directory_iterator i(root / under), end; i != end; ++i) {
    if (ignored(i->path())) {
      i.disable_recursion_pending();
    } else if (i->is_regular_file() &&
               (extensions.empty() || extensions.count(i->path().extension().string()) > 0)) {
      out.push_back(fs::relative(i->path(), root).generic_string());
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

inline std::string read(const fs::path& relative) {
  std::ifstream in(root / relative, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

inline std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

}  // namespace sutura::house
