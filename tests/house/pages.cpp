// The pages say what is there: links resolve, paths exist, listed code is the code, stages are the
// stages.
#include <gtest/gtest.h>

#include <map>
#include <regex>

#include "house/tree.h"
#include "sutura/simulation.h"

namespace sutura::house {
namespace {

std::vector<std::string> pages() {
  std::vector<std::string> out;
  for (const std::string& file : files({".md"})) out.push_back(file);
  return out;
}

/// The text outside of fenced blocks.
std::string prose(const std::string& text) {
  std::string out;
  bool fenced = false;
  for (const std::string& line : lines(text)) {
    if (line.starts_with("```"))
      fenced = !fenced;
    else if (!fenced)
      out += line + "\n";
  }
  return out;
}

TEST(Pages, LinksResolve) {
  const std::regex link(R"(\]\(([^)#\s]+)(#[^)]*)?\))");
  for (const std::string& page : pages()) {
    const std::string text = prose(read(page));
    for (std::sregex_iterator i(text.begin(), text.end(), link), end; i != end; ++i) {
      const std::string target = (*i)[1];
      if (target.find("://") != std::string::npos) continue;
      EXPECT_TRUE(fs::exists(root / fs::path(page).parent_path() / target))
          << page << " links to " << target;
    }
  }
}

TEST(Pages, PathsInCodeTypeExist) {
  const std::regex path(R"(`((?:src|include|plugins|scenes|tests|docs)/[\w./-]+)`)");
  for (const std::string& page : pages()) {
    const std::string text = prose(read(page));
    for (std::sregex_iterator i(text.begin(), text.end(), path), end; i != end; ++i) {
      EXPECT_TRUE(fs::exists(root / std::string((*i)[1]))) << page << " names " << (*i)[1];
    }
  }
}

// A fenced block after `<!-- file: PATH -->` is a piece of that file; the pieces, in order, are the
// whole of it. So a reader who types in the page has the file.
TEST(Pages, ListedFilesAreTheFiles) {
  std::size_t listed = 0;
  for (const std::string& page : pages()) {
    std::map<std::string, std::string> pieces;
    std::string file;
    bool fenced = false;
    for (const std::string& line : lines(read(page))) {
      if (line.starts_with("<!-- file: ")) {
        file = line.substr(11, line.find(" -->") - 11);
      } else if (line.starts_with("```")) {
        if (fenced) file.clear();
        fenced = !fenced;
      } else if (fenced && !file.empty()) {
        pieces[file] += line + "\n";
      }
    }
    for (const auto& [name, text] : pieces) {
      EXPECT_EQ(text, read(name)) << page << " lists " << name << " differently";
      ++listed;
    }
  }
  EXPECT_GE(listed, 5u) << "docs/extend lists the files of plugins/hello_law";
}

TEST(Pages, TheStepHasTheStagesOfTheCode) {
  std::vector<std::string> headings;
  for (const std::string& line : lines(prose(read("docs/step.md")))) {
    if (line.starts_with("## ")) headings.push_back(line.substr(3));
  }
  ASSERT_GE(headings.size(), stage_names.size());
  for (std::size_t i = 0; i < stage_names.size(); ++i) {
    EXPECT_EQ(headings[i], std::to_string(i + 1) + ". " + std::string(stage_names[i]));
  }
}

}  // namespace
}  // namespace sutura::house
