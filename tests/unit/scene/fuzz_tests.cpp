// The reader never crashes and never stays silent: seeded mutations of a good scene. Run it under
// AddressSanitizer and UBSan (preset asan) for its full worth.
#include <gtest/gtest.h>

#include <random>

#include "unit/scene/toys.h"

namespace sutura::toys {
namespace {

const std::string good = R"(<?xml version="1.0"?>
<!-- a good scene -->
<sutura version="1" dt="20 ms" gravity="0 0 -9.81" duration="4 s">
  <node name="skin">
    <Ball radius="5 mm" stiffness="30 kPa" count="7" hollow="true" label="a &lt; b &#65;"
          file="x/y.msh" centre="1 2 3 mm" weights="1,2, 3 N/mm" colour="green"/>
    <node name="deep"><CubeBox edge="1.5e-3"/></node>
  </node>
  <Rod name="rod" shape="/skin/ball"/>
  <Mark shape="skin/deep" rod="rod"/>
</sutura>
)";

/// Pieces that matter to the grammar of XML, of numbers, of paths and of names.
const std::vector<std::string> pieces{"<",
                                      ">",
                                      "/>",
                                      "</",
                                      "\"",
                                      "'",
                                      "&",
                                      "&amp;",
                                      ";",
                                      "=",
                                      "<!--",
                                      "-->",
                                      "<?",
                                      "?>",
                                      "<![",
                                      "]]>",
                                      "<!",
                                      "\n",
                                      "\t",
                                      "..",
                                      "/",
                                      ".",
                                      "nan",
                                      "inf",
                                      "1e999",
                                      "-",
                                      "+",
                                      "0x",
                                      "1e-400",
                                      "mm",
                                      "^",
                                      "^-9",
                                      "1/s",
                                      ",",
                                      "%",
                                      "\xff",
                                      "\xc2",
                                      std::string(1, '\0'),
                                      "99999999999999999999",
                                      "<node name='a'>",
                                      "</node>",
                                      "<Ball/>",
                                      "<plugin name='x'/>",
                                      "name=\"ball\"",
                                      "shape=''",
                                      "version",
                                      "sutura",
                                      "&#0;",
                                      "&#x41;",
                                      " "};

std::string mutate(std::string text, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  for (std::size_t changes = 1 + below(4); changes > 0 && !text.empty(); --changes) {
    const std::size_t at = below(text.size());
    const std::size_t length = std::min<std::size_t>(1 + below(12), text.size() - at);
    switch (below(6)) {
      case 0:
        text.erase(at, length);
        break;
      case 1:
        text.insert(at, pieces[below(pieces.size())]);
        break;
      case 2:
        text.replace(at, length, pieces[below(pieces.size())]);
        break;
      case 3:
        text[at] = static_cast<char>(below(256));
        break;
      case 4:
        text.insert(below(text.size()), text.substr(at, length * 4));
        break;
      case 5:
        text.resize(at);
        break;
    }
  }
  return text;
}

TEST(Fuzz, TheSeedIsGood) {
  const auto l = load_raw(good);
  EXPECT_TRUE(l->scene) << l->text();
}

TEST(Fuzz, MutatedScenesLoadOrSayWhyNot) {
  std::mt19937 random(20241121);
  int loaded = 0, refused = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::string text = mutate(good, random);
    const auto l = load_raw(text);
    ASSERT_EQ(l->scene == nullptr, !l->diagnostics.ok()) << text;
    if (!l->scene) {
      ++refused;
      for (const Diagnostic& d : l->diagnostics.all()) {
        ASSERT_FALSE(d.message.empty()) << text;
        ASSERT_LT(d.message.size(), 1000u) << text;
      }
      continue;
    }
    ++loaded;
    const std::string written = write_scene(*l->scene);
    const auto again = load_raw(written);
    ASSERT_TRUE(again->scene) << text << '\n' << written << again->text();
    ASSERT_EQ(write_scene(*again->scene), written);
  }
  // Both paths are exercised: about one mutant in forty still loads.
  EXPECT_GT(loaded, 200);
  EXPECT_GT(refused, 10000);
}

TEST(Fuzz, MutatedSettingsLoadOrSayWhyNot) {
  std::mt19937 random(7);
  for (int i = 0; i < 5000; ++i) {
    Registry registry = toys::registry();
    Diagnostics diagnostics;
    LoadOptions options;
    options.overrides = {{mutate("/skin/ball.radius", random), mutate("3.5 mm", random)},
                         {mutate(".dt", random), mutate("1e-2 s", random)}};
    const auto scene = load_scene_text(good, "t.xml", "/", registry, diagnostics, options);
    ASSERT_EQ(scene == nullptr, !diagnostics.ok());
  }
}

}  // namespace
}  // namespace sutura::toys
