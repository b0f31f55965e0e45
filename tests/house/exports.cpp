// What the shared library shows to the world: the C API and the C++ API.
#include <gtest/gtest.h>

#include <regex>

#include "house/command.h"
#include "house/tree.h"

namespace sutura::house {
namespace {

/// Names that a program or plugin can link to, demangled.
std::vector<std::string> exported() {
  const std::string line =
      "nm --dynamic --demangle --defined-only --format=posix " SUTURA_BINARY_DIR
      "/lib/libsutura.so";
  std::string text;
  FILE* pipe = popen(line.c_str(), "r");
  if (pipe == nullptr) return {};
  std::array<char, 4096> buffer;
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe))
    text.append(buffer.data(), n);
  EXPECT_EQ(pclose(pipe), 0) << line;
  return lines(text);
}

/// Functions that the header declares.
std::set<std::string> declared() {
  const std::string header = read("include/sutura/sutura.h");
  const std::regex function(R"(SUTURA_C [\w* ]*?(sutura_\w+)\()");
  std::set<std::string> out;
  for (std::sregex_iterator i(header.begin(), header.end(), function), end; i != end; ++i)
    out.insert((*i)[1]);
  return out;
}

TEST(Exports, AreTheApisAndNothingElse) {
  std::set<std::string> of_c;
  std::size_t of_cpp = 0;
  for (const std::string& symbol : exported()) {
    if (symbol.starts_with("sutura_"))
      of_c.insert(symbol.substr(0, symbol.find(' ')));
    else if (symbol.find("sutura::") != std::string::npos)
      ++of_cpp;
    else
      ADD_FAILURE() << symbol;
  }
  EXPECT_GT(of_cpp, 100u);
  EXPECT_EQ(of_c, declared());
}

TEST(Exports, EveryFunctionIsExplainedWhereItIsDeclared) {
  const std::vector<std::string> header = lines(read("include/sutura/sutura.h"));
  std::size_t explained = 0;
  for (std::size_t i = 1; i < header.size(); ++i) {
    if (!header[i].starts_with("SUTURA_C ")) continue;
    EXPECT_TRUE(header[i - 1].ends_with("*/")) << header[i];
    ++explained;
  }
  EXPECT_EQ(explained, declared().size());
}

// Whoever adds a function tells of it in every language.
TEST(Exports, EveryFunctionIsInThePageOfC) {
  const std::string page = read("docs/embed/c.md");
  for (const std::string& function : declared())
    EXPECT_NE(page.find('`' + function + '`'), std::string::npos) << function;
}

}  // namespace
}  // namespace sutura::house
