// Links: by path, by being the only one in reach, and what is said when neither works.
#include <gtest/gtest.h>

#include "unit/scene/toys.h"

namespace sutura::toys {
namespace {

/// The path that the link `shape` of the rod got.
std::string shape_of(const std::string& body, const std::string& rod) {
  const auto l = load(body);
  if (!l->scene) return l->text();
  const Component* owner = l->scene->find(rod);
  return l->scene->links_of(*owner).front()->path();
}

TEST(Links, OnlyOneInReach) {
  EXPECT_EQ(shape_of("<Ball/><Rod/>", "/rod"), "/ball");
  EXPECT_EQ(shape_of("<Rod/><Ball/>", "/rod"), "/ball");  // order is no matter
  EXPECT_EQ(shape_of("<Ball/><node name='n'><Rod/></node>", "/n/rod"), "/ball");
  EXPECT_EQ(shape_of("<Rod/><node name='n'><Ball/></node>", "/rod"), "/n/ball");
  EXPECT_EQ(shape_of("<node name='m'><Rod/></node><node name='n'><Ball/></node>", "/m/rod"),
            "/n/ball");
}

TEST(Links, TheNearestLevelDecides) {
  EXPECT_EQ(shape_of("<Ball/><node name='n'><Ball/><Rod/></node>", "/n/rod"), "/n/ball");
  EXPECT_EQ(shape_of("<Ball/><node name='n'><Rod/><node name='k'><Ball/></node></node>", "/n/rod"),
            "/n/k/ball");
}

TEST(Links, MoreThanOneIsAnErrorThatListsThem) {
  const auto l = load("<Ball/><node name='n'><CubeBox edge='1'/></node>\n<Rod/>");
  EXPECT_FALSE(l->scene);
  EXPECT_EQ(
      l->text(),
      "t.xml:3: error: [/rod] shape: left out, but more than one Shape is in reach: /ball and "
      "/n/cube_box; say which\n");
}

TEST(Links, NoneIsAnErrorThatSaysWhatWouldDo) {
  const auto l = load("<Rod/>");
  EXPECT_FALSE(l->scene);
  EXPECT_EQ(
      l->text(),
      "t.xml:2: error: [/rod] shape: no Shape is in the scene; <Ball> and <CubeBox> would do\n");
}

TEST(Links, ByPath) {
  const std::string tree = "<Ball/><node name='n'><Ball/><node name='k'><Ball name='b'/></node>";
  EXPECT_EQ(shape_of(tree + "<Rod shape='/ball'/></node>", "/n/rod"), "/ball");
  EXPECT_EQ(shape_of(tree + "<Rod shape='../ball'/></node>", "/n/rod"), "/ball");
  EXPECT_EQ(shape_of(tree + "<Rod shape='ball'/></node>", "/n/rod"), "/n/ball");
  EXPECT_EQ(shape_of(tree + "<Rod shape='k/b'/></node>", "/n/rod"), "/n/k/b");
  EXPECT_EQ(shape_of(tree + "<Rod shape='./k/../ball'/></node>", "/n/rod"), "/n/ball");
}

TEST(Links, APathToANodeMeansTheOnlyOneInIt) {
  EXPECT_EQ(shape_of("<node name='n'><Ball/></node><node name='m'><Ball/></node><Rod shape='n'/>",
                     "/rod"),
            "/n/ball");
  const auto many = load("<node name='n'><Ball/><CubeBox edge='1'/></node><Rod shape='n'/>");
  EXPECT_NE(many->text().find("more than one Shape is in the node 'n': /n/ball and /n/cube_box"),
            std::string::npos)
      << many->text();
  const auto none = load("<Ball/><node name='n'/><Rod shape='n'/>");
  EXPECT_NE(none->text().find("the node 'n' has no Shape; a Shape is at /ball"), std::string::npos)
      << none->text();
}

TEST(Links, WrongPathsSayWhatWasMeant) {
  const auto says = [](const std::string& body, const std::string& what) {
    const auto l = load(body);
    EXPECT_FALSE(l->scene);
    EXPECT_EQ(l->diagnostics.errors(), 1u) << l->text();
    EXPECT_NE(l->text().find(what), std::string::npos) << l->text();
  };
  says("<Ball/><Rod shape='/bal'/>", "shape: there is nothing at '/bal'; did you mean '/ball'?");
  says("<Ball/><Rod shape='../ball'/>", "climbs above the root");
  says("<Ball/><Rod name='r' next='/ball'/>", "next: '/ball' is a Ball; expected a Rod");
  says("<Ball/><Rod name='r' next='r'/>", "'r' is the component itself");
  says("<Ball/><Rod shape=''/>", "shape: the path is empty");
  says("<Ball/><Rod shap='ball'/>", "no attribute 'shap'; did you mean 'shape'?");
}

TEST(Links, OptionalMayStayEmpty) {
  const auto l = load("<Ball/><Rod/>");
  ASSERT_TRUE(l->scene) << l->text();
  EXPECT_FALSE(l->get<Rod>("/rod").next);
  EXPECT_EQ(l->scene->links_of(l->get<Rod>("/rod")).size(), 1u);
  const auto two = load("<Ball/><Rod name='a'/><Rod name='b' next='a'/>");
  EXPECT_FALSE(two->scene);  // a left out: the only other rod is b, and b links to a
  EXPECT_NE(two->text().find("links form a ring: "), std::string::npos) << two->text();
}

TEST(Links, RingsAreErrors) {
  const auto l = load(
      "<Ball/><Rod name='a' next='b'/>\n<Rod name='b' next='c'/><Rod name='c' next='a'/><Rod "
      "name='d' next='a'/>");
  EXPECT_FALSE(l->scene);
  EXPECT_EQ(l->text(), "t.xml:2: error: [/a] links form a ring: /a -> /b -> /c -> /a\n");
}

TEST(Links, ErrorsDoNotCascade) {
  const auto l = load("<Bal/><Rod/>");  // the shape that is missing is the one misspelt
  EXPECT_EQ(l->diagnostics.errors(), 1u) << l->text();
  const auto named = load("<Bal name='x'/><Ball/><Rod shape='x'/>");
  EXPECT_EQ(named->diagnostics.errors(), 1u) << named->text();
}

}  // namespace
}  // namespace sutura::toys
