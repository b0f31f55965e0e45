// A component that throws while it is initialised is named, with its plugin; a program that runs on
// has a diagnostic and no exception.
#include <gtest/gtest.h>

#include <new>
#include <stdexcept>

#include "sutura/simulation.h"

namespace sutura {
namespace {

struct Thrower : Component {
  std::string what;
  static void describe(Describe<Thrower>& d) {
    d.summary("Throws.");
    d.attribute("what", &Thrower::what, "What it throws.");
  }
  void initialise(Setup&) override {
    if (what == "memory") throw std::bad_alloc();
    if (what == "number") throw 7;
    throw std::runtime_error("boom");
  }
};

Diagnostics compile(const std::string& what) {
  Registry registry;
  registry.begin_plugin("fireworks");
  registry.component<Thrower>("Thrower");
  registry.end_plugin();
  Diagnostics diagnostics;
  auto scene = load_scene_text(
      "<sutura version='1'>\n<plugin name='fireworks'/>\n<Thrower what='" + what + "'/></sutura>",
      "test.xml", ".", registry, diagnostics);
  EXPECT_TRUE(scene);
  EXPECT_FALSE(scene && Simulation::compile(std::move(scene), "", diagnostics));
  return diagnostics;
}

TEST(AComponentThatThrows, IsNamed) {
  const Diagnostics d = compile("sentence");
  ASSERT_EQ(d.errors(), 1u);
  EXPECT_EQ(d.exit_code(), 70);
  const std::string text = d.all().front().text();
  EXPECT_TRUE(text.starts_with("test.xml:3: error: [/thrower] Thrower failed")) << text;
  EXPECT_NE(text.find("boom (a fault in the plugin 'fireworks'"), std::string::npos) << text;
}

TEST(AComponentThatThrows, MayThrowAnything) {
  EXPECT_EQ(compile("number").exit_code(), 70);
}

TEST(AComponentThatThrows, WantsTooMuch) {
  const Diagnostics d = compile("memory");
  EXPECT_EQ(d.exit_code(), 2);
  EXPECT_NE(d.all().front().message.find("more memory than there is"), std::string::npos);
}

}  // namespace
}  // namespace sutura
