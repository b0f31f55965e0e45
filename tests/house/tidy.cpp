// The tree stays readable: short files, no stray characters, no names of machines, a known top
// level.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "house/tree.h"

namespace sutura::house {
namespace {

const std::set<std::string> text_extensions{".h",    ".cpp", ".cmake", ".txt", ".md", ".xml",
                                            ".json", ".py",  ".in",    ".sh",  ".yml"};

bool is_text(const std::string& file) {
  const fs::path p = file;
  if (file.starts_with("tests/reference/") && p.extension() != ".md") return false;  // data
  if (file.starts_with("tests/scenes/malformed")) return false;  // wrong on purpose
  return text_extensions.count(p.extension().string()) > 0 || file == "dev" || file == ".ci/run";
}

TEST(Tidy, TopLevelHoldsOnlyWhatTheMapShows) {
  const std::set<std::string> known{
      "CMakeLists.txt", "CMakePresets.json", "LICENSE", "README.md", "dev",  "docs",
      "include",        "plugins",           "scenes",  "src",       "tests"};
  for (const auto& entry : fs::directory_iterator(root)) {
    const std::string name = entry.path().filename().string();
    if (name.front() == '.' || ignored(entry.path())) continue;
    EXPECT_TRUE(known.count(name) > 0) << name << " is not on the map of the top level";
  }
  for (const std::string& name : known)
    EXPECT_TRUE(fs::exists(root / name)) << name << " is missing";
}

TEST(Tidy, NoFileIsLongerThanAScreenfulOfSubjects) {
  constexpr std::size_t longest = 400;
  const std::map<std::string, std::string> reasons{};  // file -> why it may be longer
  for (const std::string& file : files({".h", ".cpp", ".py"})) {
    const std::size_t n = lines(read(file)).size();
    EXPECT_TRUE(n <= longest || reasons.count(file) > 0) << file << " has " << n << " lines";
  }
}

TEST(Tidy, NoLineOfCodeIsWiderThanAPage) {
  constexpr std::size_t widest = 100;  // characters, as .clang-format has it
  for (const std::string& file : files({".h", ".cpp"})) {
    const std::vector<std::string> all = lines(read(file));
    for (std::size_t i = 0; i < all.size(); ++i) {
      const std::string& line = all[i];
      // Bytes 10xxxxxx of UTF-8 continue a character.
      const auto width = std::count_if(line.begin(), line.end(),
                                       [](unsigned char c) { return (c & 0xC0) != 0x80; });
      EXPECT_LE(static_cast<std::size_t>(width), widest) << file << ":" << i + 1;
    }
  }
}

TEST(Tidy, NoTabsNoTrailingBlanksALineBreakAtTheEnd) {
  for (const std::string& file : files()) {
    if (!is_text(file)) continue;
    const std::string text = read(file);
    EXPECT_TRUE(text.empty() || text.back() == '\n') << file << ": no line break at the end";
    const std::vector<std::string> all = lines(text);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const std::string& line = all[i];
      EXPECT_EQ(line.find('\t'), std::string::npos) << file << ":" << i + 1 << ": tab";
      if (!line.empty()) {
        EXPECT_FALSE(line.back() == ' ' || line.back() == '\r')
            << file << ":" << i + 1 << ": blank at the end";
      }
    }
  }
}

TEST(Tidy, NoPathOfSomebodysMachine) {
  // Put together here so that this file does not find itself.
  const std::vector<std::string> roots{
      "/wo"
      "rk/",
      "/tm"
      "p/wt",
      "/ho"
      "me/",
      "/ro"
      "ot/",
      "/Use"
      "rs/"};
  for (const std::string& file : files()) {
    if (!is_text(file)) continue;
    const std::vector<std::string> all = lines(read(file));
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (const std::string& r : roots) {
        EXPECT_EQ(all[i].find(r), std::string::npos) << file << ":" << i + 1 << ": " << r;
      }
    }
  }
}

// Work that is put off is an issue with an owner, not a comment.
TEST(Tidy, NothingIsLeftForLater) {
  for (const std::string& file : files({".h", ".cpp", ".py", ".cmake", ".xml"})) {
    const std::string text = read(file);
    for (const std::string& word :
         {std::string("TO") + "DO", std::string("FIX") + "ME", std::string("XX") + "X"}) {
      EXPECT_EQ(text.find(word), std::string::npos) << file << " holds a " << word;
    }
  }
}

}  // namespace
}  // namespace sutura::house
