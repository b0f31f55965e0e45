// A scene written back loads to the same scene.
#include <gtest/gtest.h>

#include "unit/scene/toys.h"

namespace sutura::toys {
namespace {

/// Everything a simulation could see of a scene.
std::string digest(const Scene& s) {
  std::string out = std::to_string(s.dt) + ' ' + std::to_string(s.duration);
  for (const Component* c : s.components()) {
    out += '\n' + c->path() + ':';
    for (const Component* target : s.links_of(*c)) out += ' ' + target->path();
  }
  return out;
}

// `count` is given its default: written all the same, for a component may look up what is not said.
TEST(Writer, WritesWhatTheSceneSays) {
  const auto l = load("<node name='n'><Ball radius='3 mm' colour='blue' count='2'/></node><Rod/>");
  ASSERT_TRUE(l->scene) << l->text();
  EXPECT_EQ(write_scene(*l->scene), R"(<sutura version="1" dt="0.01 s" gravity="0 0 -9.81">
  <node name="n">
    <Ball radius="0.003 m" count="2" colour="blue"/>
  </node>
  <Rod shape="/n/ball"/>
</sutura>
)");
}

TEST(Writer, WrittenScenesLoadToTheSame) {
  const auto first = load(R"(<node name="n"><Mark name="m1" shape="/b"/></node>
<node name="a">
  <CubeBox edge="0.1234567890123456789 mm"/>
  <node name="empty"/>
  <Rod name="r2" shape="cube_box"/>
</node>
<Ball name="b" label="&quot;&lt;&amp;&gt;' x" hollow="true" weights="0.1 0.2 0.3" centre="1 2 3"
      file="some/where.msh" radius="1e-300"/>
<node name="c"><Mark name="m2" shape="/b" rod="../a"/></node>)",
                          {.overrides = {{".duration", "4 s"}, {".dt", "0.1 ms"}}});
  ASSERT_TRUE(first->scene) << first->text();
  const std::string text = write_scene(*first->scene);
  const auto second = load_raw(text);
  ASSERT_TRUE(second->scene) << second->text() << text;
  EXPECT_EQ(digest(*second->scene), digest(*first->scene));
  EXPECT_EQ(write_scene(*second->scene), text);
  EXPECT_EQ(second->scene->dt, first->scene->dt);
  EXPECT_EQ(second->scene->gravity, first->scene->gravity);
  EXPECT_EQ(second->get<CubeBox>("/a/cube_box").edge, first->get<CubeBox>("/a/cube_box").edge);
  const Ball& b = second->get<Ball>("/b");
  EXPECT_EQ(b.label, "\"<&>' x");
  EXPECT_EQ(b.radius, 1e-300);
  EXPECT_EQ(b.weights, (std::vector<Real>{0.1, 0.2, 0.3}));
  EXPECT_EQ(b.file.path, "some/where.msh");
}

TEST(Writer, LinksThatAreEmptyStayEmpty) {
  const auto first = load("<Ball/><Mark/>");
  ASSERT_TRUE(first->scene) << first->text();
  EXPECT_FALSE(first->get<Mark>("/mark").rod);
  const std::string text = write_scene(*first->scene);
  EXPECT_NE(text.find("<Mark shape=\"/ball\"/>"), std::string::npos) << text;
  EXPECT_TRUE(load_raw(text)->scene);
}

TEST(Writer, PluginsAreNamed) {
  Loaded l;
  l.registry.begin_plugin("extra");
  l.registry.end_plugin();
  l.scene = load_scene_text("<sutura version='1'><plugin name='extra'/></sutura>", "t.xml", "/",
                            l.registry, l.diagnostics);
  ASSERT_TRUE(l.scene) << l.text();
  EXPECT_NE(write_scene(*l.scene).find("  <plugin name=\"extra\"/>\n"), std::string::npos);
}

}  // namespace
}  // namespace sutura::toys
