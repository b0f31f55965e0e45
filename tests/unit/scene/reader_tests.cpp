// Elements, attributes and names: what is read and what is refused.
#include <gtest/gtest.h>

#include "scene/attributes.h"
#include "unit/scene/toys.h"

namespace sutura::toys {
namespace {

bool has(const Loaded& loaded, const std::string& text) {
  return loaded.text().find(text) != std::string::npos;
}
#define EXPECT_SAYS(loaded, what) EXPECT_TRUE(has(*(loaded), what)) << (loaded)->text()

TEST(Reader, ReadsEveryTypeOfAttribute) {
  const auto l =
      load(R"(<Ball radius="5 mm" stiffness="2 kPa" count="7" hollow="true" label="a &lt; b"
      file="x/y.msh" centre="1 2 3 mm" weights="1 2 3 N/mm" colour="green"/>)");
  ASSERT_TRUE(l->scene) << l->text();
  const Ball& b = l->get<Ball>("/ball");
  EXPECT_EQ(b.radius, 5e-3);
  EXPECT_EQ(b.stiffness, 2000);
  EXPECT_EQ(b.count, 7);
  EXPECT_TRUE(b.hollow);
  EXPECT_EQ(b.label, "a < b");
  EXPECT_EQ(b.file.path, "x/y.msh");
  EXPECT_EQ(b.centre, Vec3(1e-3, 2e-3, 3e-3));
  EXPECT_EQ(b.weights, (std::vector<Real>{1000, 2000, 3000}));
  EXPECT_EQ(b.colour, Ball::Colour::green);
  EXPECT_EQ(b.name(), "ball");
  EXPECT_EQ(b.path(), "/ball");
  EXPECT_EQ(b.location().line, 2);
  EXPECT_EQ(b.info().name, "Ball");
}

TEST(Reader, SettingsOfTheScene) {
  const auto l = load_raw(R"(<?xml version="1.0"?><!-- c -->
<sutura version="1" dt="20 ms" gravity="0 0 -981 cm/s^2" duration="4 s"/>)");
  ASSERT_TRUE(l->scene) << l->text();
  EXPECT_EQ(l->scene->dt, 0.02);
  EXPECT_EQ(l->scene->gravity, Vec3(0, 0, -9.81));
  EXPECT_EQ(l->scene->duration, 4);
}

TEST(Reader, NodesNestAndNamesFollowTags) {
  const auto l =
      load(R"(<node name="a"><node name="b"><CubeBox edge="1"/><Ball name="x-1"/></node></node>
<Ball/>)");
  ASSERT_TRUE(l->scene) << l->text();
  const auto all = l->scene->components();
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0]->path(), "/a/b/cube_box");
  EXPECT_EQ(all[1]->path(), "/a/b/x-1");
  EXPECT_EQ(all[2]->path(), "/ball");
  EXPECT_EQ(l->scene->find("/a/b/x-1"), all[1]);
  EXPECT_EQ(l->scene->find("/a/b"), nullptr);
  const Node& a = *l->scene->root.children.front();
  EXPECT_EQ(a.path, "/a");
  EXPECT_EQ(a.parent, &l->scene->root);
  EXPECT_EQ(l->scene->root.path, "/");
}

TEST(Reader, DefaultNames) {
  EXPECT_EQ(default_name("TetMesh"), "tet_mesh");
  EXPECT_EQ(default_name("Tissue"), "tissue");
  EXPECT_EQ(default_name("SutureThread"), "suture_thread");
  EXPECT_EQ(default_name("CSVProbe"), "csv_probe");
  EXPECT_EQ(default_name("VtuRecorder2"), "vtu_recorder2");
}

struct Refusal {
  const char* body;  // from line 2 of the file on
  int line;          // of the error
  const char* says;  // part of the message
};

void PrintTo(const Refusal& r, std::ostream* out) {
  *out << r.body;
}

class Refuses : public testing::TestWithParam<Refusal> {};

TEST_P(Refuses, WithLineAndReason) {
  const auto l = load(GetParam().body);
  EXPECT_FALSE(l->scene);
  ASSERT_FALSE(l->diagnostics.ok());
  EXPECT_EQ(l->diagnostics.all().front().location.line, GetParam().line) << l->text();
  EXPECT_EQ(l->diagnostics.all().front().location.file, "t.xml");
  EXPECT_EQ(l->diagnostics.exit_code(), 2);
  EXPECT_SAYS(l, GetParam().says);
}

INSTANTIATE_TEST_SUITE_P(
    Elements, Refuses,
    testing::Values(
        Refusal{"<Bal/>", 2, "no component <Bal>; did you mean <Ball>?"},
        Refusal{"\n<nod name=\"a\"/>", 3, "did you mean <node>?"},
        Refusal{"<Helicopter/>", 2, "no component <Helicopter>"},
        Refusal{"<node/>", 2, "<node> needs a name"},
        Refusal{"<node name=\"\"/>", 2, "'' cannot be a name"},
        Refusal{"<node name=\"a/b\"/>", 2, "'a/b' cannot be a name"},
        Refusal{"<node name=\"a\" colour=\"red\"/>", 2, "<node> has no attribute 'colour'"},
        Refusal{"<node name=\"a\">hello</node>", 2, "text inside <node>"},
        Refusal{"<node name=\"a\"><plugin name=\"b\"/></node>", 2, "directly below <sutura>"},
        Refusal{"<Ball>\n<Rod/></Ball>", 3, "<Rod> inside <Ball>"},
        Refusal{"<Ball>x</Ball>", 2, "text inside <Ball>"},
        Refusal{"<Ball/>\n<Ball/>", 3, "the name 'ball' is taken"},
        Refusal{"<node name=\"ball\"/>\n<Ball/>", 3, "the name 'ball' is taken"},
        Refusal{"<plugin/>", 2, "<plugin> needs a name"},
        Refusal{"<plugin name=\"a\" file=\"b\"/>", 2, "<plugin> has no attribute 'file'"},
        Refusal{"hello", 2, "text inside <sutura>"}));

INSTANTIATE_TEST_SUITE_P(
    Attributes, Refuses,
    testing::Values(
        Refusal{"<Ball raduis=\"1\"/>", 2,
                "[/ball] <Ball> has no attribute 'raduis'; did you mean 'radius'?"},
        Refusal{"<Ball\n radius=\"0\"/>", 3, "radius: '0' is out of range: it must be above 0 m"},
        Refusal{"<Ball stiffness=\"2 GPa\"/>", 2, "between 0 and 1e+09 Pa"},
        Refusal{"<Ball radius=\"nan\"/>", 2, "radius: 'nan' is not a number"},
        Refusal{"<Ball radius=\"inf\"/>", 2, "'inf' is not a number"},
        Refusal{"<Ball radius=\"1.5abc\"/>", 2, "'abc' is not a unit"},
        Refusal{"<Ball radius=\"1 kPa\"/>", 2, "expected a unit like m"},
        Refusal{"<Ball radius=\"\"/>", 2, "the value is empty"},
        Refusal{"<Ball count=\"1.5\"/>", 2, "count: '1.5' is not a whole number"},
        Refusal{"<Ball count=\"0\"/>", 2, "must be at least 1"},
        Refusal{"<Ball count=\"99999999999999999999\"/>", 2, "is too large"},
        Refusal{"<Ball hollow=\"yes\"/>", 2, "neither 'true' nor 'false'"},
        Refusal{"<Ball file=\"\"/>", 2, "the name of the file is empty"},
        Refusal{"<Ball centre=\"1 2\"/>", 2, "has 2 numbers; expected 3"},
        Refusal{"<Ball centre=\"1 2 3 4\"/>", 2, "has 4 numbers; expected 3"},
        Refusal{"<Ball weights=\"1 -1\"/>", 2, "must be at least 0 N/m"},
        Refusal{"<Ball colour=\"gren\"/>", 2, "not one of red, green, blue; did you mean 'green'?"},
        Refusal{"<Ball name=\"9\"/>", 2, "'9' cannot be a name"},
        Refusal{"\n\n<CubeBox/>", 4, "<CubeBox> needs the attribute 'edge'"}));

TEST(Reader, RefusesSettings) {
  const auto refuse = [](const std::string& root, const std::string& says) {
    const auto l = load_raw(root);
    EXPECT_FALSE(l->scene);
    EXPECT_SAYS(l, says);
    EXPECT_EQ(l->diagnostics.exit_code(), 2);
  };
  refuse("<sutura/>", "t.xml:1: error: <sutura> needs version");
  refuse("<sutura version='2'/>", "'2' is not supported");
  refuse("<scene version='1'/>", "the root element is <scene>");
  refuse("<sutura version='1' dt='0'/>",
         "dt: '0' is out of range: it must be between 1e-09 and 10000 s");
  refuse("<sutura version='1' dt='1 m'/>", "dt: '1 m' has the wrong unit");
  refuse("<sutura version='1' duration='-1'/>", "between 0 and 1000000 s");
  refuse("<sutura version='1' gravity='1 2'/>", "gravity: '1 2': expected 3 numbers");
  refuse("<sutura version='1' gravty='1 2 3'/>", "no attribute 'gravty'; did you mean 'gravity'?");
}

TEST(Reader, CollectsEverythingInOnePass) {
  const auto l = load(R"(<Bal/>
<Ball radius="-1" count="x"/>
<CubeBox/>
<Rod shape="/nowhere"/>)");
  EXPECT_FALSE(l->scene);
  EXPECT_EQ(l->diagnostics.errors(), 5u) << l->text();
}

TEST(Reader, MissingFileIsAFileError) {
  Registry r = toys::registry();
  Diagnostics d;
  EXPECT_FALSE(load_scene("/nowhere/at/all.xml", r, d));
  EXPECT_EQ(d.exit_code(), 3);
  Diagnostics folder;
  EXPECT_FALSE(load_scene("/", r, folder));
  EXPECT_EQ(folder.exit_code(), 3);
}

TEST(Reader, AttributeOfAnotherPluginNeedsItsPlugin) {
  Loaded l;
  l.registry.begin_plugin("extra");
  struct Extra : Component {
    static void describe(Describe<Extra>& d) { d.summary("Extra."); }
  };
  l.registry.component<Extra>("Extra");
  l.registry.end_plugin();
  const auto read = [&](const std::string& text) {
    l.diagnostics = {};
    l.scene = load_scene_text(text, "t.xml", "/", l.registry, l.diagnostics);
  };
  read("<sutura version='1'><Extra/></sutura>");
  EXPECT_FALSE(l.scene);
  EXPECT_TRUE(has(l, "add <plugin name=\"extra\"/>")) << l.text();
  read("<sutura version='1'><plugin name='extra'/><Extra/></sutura>");
  EXPECT_TRUE(l.scene) << l.text();
}

TEST(Overrides, ReplaceAndAdd) {
  const auto l = load("<node name=\"a\"><Ball radius=\"1\"/></node><Rod/>",
                      {.overrides = {{"/a/ball.radius", "3 mm"},
                                     {"/a/ball.count", "5"},
                                     {"/rod.shape", "/a/ball"},
                                     {".dt", "5 ms"},
                                     {".duration", "7"},
                                     {".duration", "8"}}});
  ASSERT_TRUE(l->scene) << l->text();
  EXPECT_EQ(l->get<Ball>("/a/ball").radius, 3e-3);
  EXPECT_EQ(l->get<Ball>("/a/ball").count, 5);
  EXPECT_EQ(l->scene->dt, 5e-3);
  EXPECT_EQ(l->scene->duration, 8);
}

TEST(Overrides, AreCheckedLikeTheFile) {
  const auto refuse = [](const std::string& target, const std::string& value,
                         const std::string& says) {
    const auto l = load("<node name=\"a\"><Ball/></node>", {.overrides = {{target, value}}});
    EXPECT_FALSE(l->scene);
    EXPECT_EQ(l->diagnostics.errors(), 1u) << l->text();
    EXPECT_SAYS(l, says);
  };
  refuse("/a/ball.raduis", "1",
         "--set /a/ball.raduis: error: [/a/ball] there is no attribute 'raduis'; did you mean "
         "'radius'?");
  refuse("/a/bal.radius", "1", "no component /a/bal; did you mean '/a/ball'?");
  refuse("/a/ball.radius", "-1",
         "--set /a/ball.radius: error: [/a/ball] radius: '-1' is out of range");
  refuse("/a/ball.name", "x", "no attribute 'name'");
  refuse("/a.x", "1", "no component /a");
  refuse(".dz", "1", "no attribute 'dz'");
  refuse(".dtt", "1", "did you mean 'dt'?");
  refuse(".dt", "0", "between 1e-09 and 10000 s");
  refuse("nonsense", "1", "expected '/path/of/component.attribute=value'");
  refuse("a.radius", "1", "expected '/path/of/component.attribute=value'");
}

}  // namespace
}  // namespace sutura::toys
