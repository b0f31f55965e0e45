// Every file in malformed/ is refused by the real command with the exit code, the line and the
// words that its first line announces: <!-- expect: CODE | LINE | WORDS -->.
#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <ostream>
#include <vector>

#include "house/command.h"

namespace sutura::house {
namespace {

namespace fs = std::filesystem;

const fs::path folder = fs::path(SUTURA_SOURCE_DIR) / "tests/scenes/malformed";

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".xml") out.push_back(entry.path().stem().string());
  std::sort(out.begin(), out.end());
  return out;
}

struct Expected {
  int code = 0;
  int line = 0;
  std::string words;
};

/// Nothing is expected (code 0) if the first line is not of that form.
Expected expected_of(const std::string& text) {
  const std::string head = "<!-- expect: ";
  const std::string first = text.substr(0, text.find('\n'));
  const std::size_t bar = first.find(" | "), end = first.rfind(" -->");
  const std::size_t second = bar == std::string::npos ? bar : first.find(" | ", bar + 3);
  if (!first.starts_with(head) || second == std::string::npos || end == std::string::npos)
    return {};
  Expected e;
  const auto number = [&](std::size_t begin, std::size_t stop, int& out) {
    std::from_chars(first.data() + begin, first.data() + stop, out);
  };
  number(head.size(), bar, e.code);
  number(bar + 3, second, e.line);
  e.words = first.substr(second + 3, end - second - 3);
  return e;
}

class Malformed : public testing::TestWithParam<std::string> {};

TEST_P(Malformed, IsRefusedAsAnnounced) {
  const fs::path file = folder / (GetParam() + ".xml");
  const Expected e = expected_of(read_text(file));
  ASSERT_GT(e.code, 0) << "the first line announces nothing";
  ASSERT_FALSE(e.words.empty());
  const Outcome out = command("check '" + file.string() + "'");
  EXPECT_EQ(out.code, e.code) << out.text;
  const std::string where = file.string() + ':' + std::to_string(e.line) + ": error: ";
  bool said = false;
  for (std::size_t at = out.text.find(where); at != std::string::npos;
       at = out.text.find(where, at + 1)) {
    const std::string line = out.text.substr(at, out.text.find('\n', at) - at);
    said = said || line.find(e.words) != std::string::npos;
  }
  EXPECT_TRUE(said) << "expected at " << where << e.words << "\nbut got\n" << out.text;
}

INSTANTIATE_TEST_SUITE_P(Scenes, Malformed, testing::ValuesIn(names()),
                         [](const auto& info) { return info.param; });

TEST(MalformedScenes, AreAtLeastSixty) {
  EXPECT_GE(names().size(), 60u);
}

// What cannot be a file with a first line that announces something.

TEST(MalformedScenes, MissingFile) {
  const Outcome out = command("check /nowhere/at/all.xml");
  EXPECT_EQ(out.code, 3);
  EXPECT_NE(out.text.find("/nowhere/at/all.xml: error: the scene does not exist"),
            std::string::npos);
}

TEST(MalformedScenes, Folder) {
  EXPECT_EQ(command("check /").code, 3);
}

TEST(MalformedScenes, EmptyFile) {
  const TemporaryFolder temporary("malformed");
  std::ofstream(temporary.path() / "empty.xml").close();
  const Outcome out = command("check " + (temporary.path() / "empty.xml").string());
  EXPECT_EQ(out.code, 2);
  EXPECT_NE(out.text.find("empty.xml:1: error: the file is empty"), std::string::npos) << out.text;
}

TEST(MalformedScenes, TooLarge) {
  const TemporaryFolder temporary("malformed");
  std::ofstream(temporary.path() / "large.xml") << std::string((16 << 20) + 1, ' ');
  const Outcome out = command("check " + (temporary.path() / "large.xml").string());
  EXPECT_EQ(out.code, 2);
  EXPECT_NE(out.text.find("at most 16777216 are read"), std::string::npos) << out.text;
}

TEST(MalformedScenes, SettingsFromTheCommandLine) {
  const TemporaryFolder temporary("malformed");
  const std::string file = (temporary.path() / "good.xml").string();
  std::ofstream(file) << "<sutura version=\"1\"><GaussSeidel/></sutura>";
  EXPECT_EQ(command("check " + file).code, 0);
  const Outcome path = command("check " + file + " --set /gaus_seidel.sweeps=3");
  EXPECT_EQ(path.code, 2);
  EXPECT_NE(path.text.find("did you mean '/gauss_seidel'?"), std::string::npos) << path.text;
  const Outcome attribute = command("check " + file + " --set /gauss_seidel.sweps=3");
  EXPECT_EQ(attribute.code, 2);
  EXPECT_NE(attribute.text.find("did you mean 'sweeps'?"), std::string::npos) << attribute.text;
  EXPECT_EQ(command("check " + file + " --set /gauss_seidel.sweeps").code, 1);
}

}  // namespace
}  // namespace sutura::house
