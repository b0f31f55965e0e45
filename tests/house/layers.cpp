// Who includes whom: base <- {scene, solve} <- runtime <- {host, app}, geometry nothing; a plugin
// sees the public headers and its own room; the public headers see Eigen and the standard library.
#include <gtest/gtest.h>

#include <map>
#include <optional>

#include "house/tree.h"

namespace sutura::house {
namespace {

struct Include {
  std::string target;
  bool angled = false;
};

std::vector<Include> includes(const std::string& file) {
  std::vector<Include> out;
  for (const std::string& line : lines(read(file))) {
    if (!line.starts_with("#include")) continue;
    const auto open = line.find_first_of("<\"");
    if (open == std::string::npos) continue;
    const bool angled = line[open] == '<';
    const auto close = line.find(angled ? '>' : '"', open + 1);
    out.push_back({line.substr(open + 1, close - open - 1), angled});
  }
  return out;
}

/// The file that a quoted include means, relative to the root: beside the includer, in src/ or in
/// include/.
std::optional<std::string> resolve(const std::string& includer, const std::string& target) {
  for (const fs::path& folder :
       {fs::path(includer).parent_path(), fs::path("src"), fs::path("include")}) {
    const fs::path candidate = (folder / target).lexically_normal();
    if (fs::exists(root / candidate)) return candidate.generic_string();
  }
  return std::nullopt;
}

/// "src/scene/reader.h" -> "src/scene"; "include/sutura/law.h" -> "include/sutura".
std::string room(const std::string& file) {
  const auto first = file.find('/');
  const auto second = file.find('/', first + 1);
  return file.substr(0, second == std::string::npos ? first : second);
}

const std::set<std::string> code{".h", ".cpp"};

TEST(Layers, OfTheLibrary) {
  const std::map<std::string, std::set<std::string>> may_see{
      {"src/base", {}},
      {"src/geometry", {}},
      {"src/scene", {"src/base"}},
      {"src/solve", {"src/base"}},
      {"src/runtime", {"src/base", "src/scene", "src/solve"}},
      {"src/host", {"src/base", "src/scene", "src/solve", "src/runtime"}},
      {"src/fmu", {}},  // a host like any other
      {"src/app", {"src/base", "src/scene", "src/solve", "src/runtime"}}};
  for (const std::string& file : files(code, "src")) {
    const auto layer = may_see.find(room(file));
    if (layer == may_see.end()) {
      ADD_FAILURE() << file << ": a layer that this test does not know";
      continue;
    }
    for (const Include& i : includes(file)) {
      if (i.angled) continue;
      const auto target = resolve(file, i.target);
      if (!target) {
        ADD_FAILURE() << file << " includes \"" << i.target << "\", which is in no layer";
        continue;
      }
      const std::string seen = room(*target);
      EXPECT_TRUE(seen == "include/sutura" || seen == layer->first || layer->second.count(seen) > 0)
          << file << " includes " << *target;
    }
  }
}

TEST(Layers, APluginSeesThePublicHeadersAndItsOwnRoom) {
  for (const std::string& file : files(code, "plugins")) {
    for (const Include& i : includes(file)) {
      if (i.angled) continue;
      const auto target = resolve(file, i.target);
      if (!target) {
        ADD_FAILURE() << file << " includes \"" << i.target << "\", which is not in its room";
        continue;
      }
      const std::string seen = room(*target);
      EXPECT_TRUE(seen == "include/sutura" || seen == room(file))
          << file << " includes " << *target;
    }
  }
}

TEST(Layers, PublicHeadersNeedEigenAndTheStandardLibraryOnly) {
  for (const std::string& file : files({".h"}, "include")) {
    for (const Include& i : includes(file)) {
      if (!i.angled) {
        EXPECT_TRUE(i.target.starts_with("sutura/")) << file << " includes " << i.target;
        continue;
      }
      if (file == "include/sutura/sutura.h") {  // the one that is C
        EXPECT_TRUE(i.target == "stddef.h" || i.target == "stdint.h") << i.target;
        continue;
      }
      // Names of the standard library have neither a dot nor a slash.
      EXPECT_TRUE(i.target.starts_with("Eigen/") ||
                  i.target.find_first_of("./") == std::string::npos)
          << file << " includes <" << i.target << ">";
    }
  }
}

TEST(Layers, LibrariesDoNotPrint) {
  for (const std::string& file : files(code)) {
    const bool library = file.starts_with("include/") || file.starts_with("plugins/") ||
                         (file.starts_with("src/") && !file.starts_with("src/app/"));
    if (!library) continue;
    const std::string text = read(file);
    for (const char* stream : {"std::cout", "std::cerr", "std::clog", "printf("}) {
      const auto at = text.find(stream);
      const bool formats_text = at != std::string::npos && at > 2 &&
                                std::string_view(stream) == "printf(" && text[at - 1] == 'n' &&
                                text[at - 2] == 's';  // snprintf writes to memory
      EXPECT_TRUE(at == std::string::npos || formats_text) << file << " uses " << stream;
    }
  }
}

}  // namespace
}  // namespace sutura::house
