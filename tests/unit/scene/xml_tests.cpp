// What is no XML, or too much of it.
#include <gtest/gtest.h>

#include "scene/xml_tree.h"
#include "unit/scene/toys.h"

namespace sutura::toys {
namespace {

struct Broken {
  std::string text;
  int line;
  const char* says;
};

void PrintTo(const Broken& b, std::ostream* out) {
  *out << b.says;
}

class NotXml : public testing::TestWithParam<Broken> {};

TEST_P(NotXml, IsRefusedWithLineAndReason) {
  const auto l = load_raw(GetParam().text);
  EXPECT_FALSE(l->scene);
  EXPECT_EQ(l->diagnostics.errors(), 1u);
  EXPECT_EQ(l->diagnostics.exit_code(), 2);
  EXPECT_EQ(l->diagnostics.all().front().location.line, GetParam().line) << l->text();
  EXPECT_NE(l->text().find(GetParam().says), std::string::npos) << l->text();
}

std::string repeated(const std::string& what, int times) {
  std::string out;
  for (int i = 0; i < times; ++i) out += what;
  return out;
}

std::string many_attributes() {
  std::string out = "<sutura version='1'>\n<Ball";
  for (int i = 0; i < 65; ++i) out += " a" + std::to_string(i) + "=''";
  return out + "/></sutura>";
}

using namespace std::string_literals;

INSTANTIATE_TEST_SUITE_P(
    Texts, NotXml,
    testing::Values(
        Broken{"", 1, "the file is empty"}, Broken{" \n ", 1, "the file is empty"},
        Broken{"<!-- only -->", 1, "has no element"}, Broken{"hello", 1, "this is not XML"},
        Broken{"{\"a\": 1}", 1, "this is not XML"},
        Broken{"<sutura version='1'>\n<Ball/>", 1, "ends before </sutura>"},
        Broken{"<sutura version='1'>\n<Ball", 2, "ends inside the tag <Ball>"},
        Broken{"<sutura version='1'>\n<Ball radius='1", 2,
               "ends inside the value of attribute 'radius'"},
        Broken{"<sutura version='1'>\n<!-- ", 2, "ends inside a comment"},
        Broken{"<sutura version='1'>\n<?x ", 2, "ends inside a processing instruction"},
        Broken{"<sutura version='1'>\n<Ball\n radius='1'\n radius='2'/></sutura>", 4,
               "attribute 'radius' is given twice in <Ball>"},
        Broken{"<sutura version='1'>\n<Ball radius/></sutura>", 2, "'radius' has no value"},
        Broken{"<sutura version='1'>\n<Ball radius=1/></sutura>", 2, "not in quotes"},
        Broken{"<sutura version='1'>\n<Ball radius='1'count='1'/></sutura>", 2,
               "a blank is missing"},
        Broken{"<sutura version='1'>\n<Ball radius='1/>\n</sutura>", 2, "are not closed"},
        Broken{"<sutura version='1'>\n<Ball =/></sutura>", 2, "'=' where an attribute"},
        Broken{"<sutura version='1'>\n<node name='a'>\n</nod></sutura>", 3,
               "</nod> where </node> was expected, opened at line 2"},
        Broken{"<sutura version='1'/>\n</sutura>", 2, "never opened"},
        Broken{"<sutura version='1'/>\n<sutura version='1'/>", 2, "a second root element"},
        Broken{"<sutura version='1'/>\nhello", 2, "text after the end"},
        Broken{"<sutura version='1'>\n<Ball label='&bogus;'/></sutura>", 2, "'&amp;'"},
        Broken{"<sutura version='1'>\n<Ball label='a & b'/></sutura>", 2, "'&amp;'"},
        Broken{"<sutura version='1'>\n<Ball label='&#0;'/></sutura>", 2, "'&amp;'"},
        Broken{"<sutura version='1'>\n<![CDATA[x]]></sutura>", 2, "CDATA"},
        Broken{"<!DOCTYPE x [<!ENTITY a \"b\">]>\n<sutura version='1'/>", 1, "a document type"},
        Broken{"<sutura version='1'>\n< Ball/></sutura>", 2, "not followed by the name"},
        Broken{"<sutura version='1'>\n<Ball/>\0</sutura>"s, 2, "NUL"},
        Broken{"<\0s\0u\0t\0"s, 1, "NUL"},
        Broken{"<sutura version='1'>\n" + repeated("<node name='a'>", 64) +
                   repeated("</node>", 64) + "</sutura>",
               2, "nested deeper than 64"},
        Broken{repeated("<a>", 1000000), 1, "nested deeper than 64"},
        Broken{many_attributes(), 2, "more than 64 attributes in <Ball>"},
        Broken{"<sutura version='1'>\n" + repeated("<Ball/>", 10001) + "</sutura>", 2,
               "more than 10000 elements"},
        Broken{repeated(" ", (16 << 20) + 1), 0, "at most 16777216 are read"}));

TEST(Xml, TheDeepestAllowedNestingIsRead) {
  const auto l = load(repeated("<node name='a'>", 62) + "<Ball/>" + repeated("</node>", 62));
  EXPECT_TRUE(l->scene) << l->text();
}

TEST(Xml, LinesOfElementsAndAttributes) {
  Diagnostics d;
  const auto tree = parse_xml("<a\n x='1'\n y='2'>\n\n<b/><!-- \n\n --><c\n/> t </a>", "f", d);
  ASSERT_TRUE(tree);
  EXPECT_EQ(tree->line, 1);
  EXPECT_EQ(tree->attributes[0].line, 2);
  EXPECT_EQ(tree->attributes[1].line, 3);
  EXPECT_EQ(tree->children[0].line, 5);
  EXPECT_EQ(tree->children[1].line, 7);
  EXPECT_GT(tree->text_line, 0);
}

TEST(Xml, ByteOrderMarkCommentsAndEntities) {
  const auto l = load_raw(
      "\xEF\xBB\xBF<?xml version='1.0' encoding='UTF-8'?>\n<!-- a -- b --><sutura "
      "version='1'><Ball "
      "label='&lt;&gt;&amp;&quot;&apos;&#65;&#x42; \u00b5 > '/></sutura>\n<!-- end -->\n");
  ASSERT_TRUE(l->scene) << l->text();
  EXPECT_EQ(l->get<Ball>("/ball").label, "<>&\"'AB \u00b5 > ");
}

}  // namespace
}  // namespace sutura::toys
