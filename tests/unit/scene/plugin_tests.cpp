// The handshake, and loading from files that are no plugins.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "sutura/plugin.h"
#include "unit/scene/toys.h"

namespace sutura::toys {
namespace {

namespace fs = std::filesystem;

int enrolled = 0;
void enrol_toys(Registry& r) {
  ++enrolled;
  r.component<Ball>("Ball");
}
void enrol_throwing(Registry&) {
  throw std::runtime_error("no memory of it");
}

PluginHeader good_header() {
  return {sizeof(PluginHeader), SUTURA_ABI, SUTURA_BUILD_TAG, "toys", "1.0",
          "Apache-2.0",         enrol_toys};
}

TEST(Plugin, EveryFieldOfTheHandshakeIsCompared) {
  EXPECT_EQ(check_plugin(good_header(), "toys"), "");
  const auto refuse = [](auto change, const std::string& says) {
    PluginHeader h = good_header();
    change(h);
    EXPECT_NE(check_plugin(h, "toys").find(says), std::string::npos) << check_plugin(h, "toys");
    Registry r;
    Diagnostics d;
    enrolled = 0;
    h.name = h.name ? h.name : "toys";
    if (std::string(h.name) == "toys") {
      EXPECT_FALSE(enrol_plugin(r, h, d));
      EXPECT_EQ(d.exit_code(), 6);
      EXPECT_EQ(enrolled, 0);
    }
  };
  refuse([](PluginHeader& h) { h.struct_size = 8; }, "another header of 8 bytes");
  refuse([](PluginHeader& h) { h.abi = 99; },
         "ABI 99; this library has ABI " + std::to_string(SUTURA_ABI));
  refuse([](PluginHeader& h) { h.build_tag = "msvc"; }, "was built as 'msvc'");
  refuse([](PluginHeader& h) { h.build_tag = nullptr; }, "was built as ''");
  refuse([](PluginHeader& h) { h.name = "games"; }, "calls itself 'games'");
  refuse([](PluginHeader& h) { h.version = ""; }, "gives no version");
  refuse([](PluginHeader& h) { h.licence = nullptr; }, "gives no licence");
  refuse([](PluginHeader& h) { h.enrol = nullptr; }, "has no enrol function");
  PluginHeader nameless = good_header();
  nameless.name = nullptr;
  EXPECT_NE(check_plugin(nameless, "toys"), "");
}

TEST(Plugin, StaticPluginsEnrolOnce) {
  Registry r;
  Diagnostics d;
  enrolled = 0;
  EXPECT_TRUE(enrol_plugin(r, good_header(), d));
  EXPECT_TRUE(enrol_plugin(r, good_header(), d));
  EXPECT_EQ(enrolled, 1);
  EXPECT_TRUE(r.has_plugin("toys"));
  ASSERT_TRUE(r.find("Ball"));
  EXPECT_EQ(r.find("Ball")->plugin, "toys");
  EXPECT_TRUE(load_plugin(r, "toys", {}, {}, d));  // there already
}

/// Described by names that the test chooses.
class Named : public Component {
 public:
  static inline std::vector<std::string> attributes, outputs;
  static void describe(Describe<Named>& d) {
    d.summary("Has names.");
    for (const std::string& name : attributes) d.attribute(name, &Named::flag, "A flag.");
    for (const std::string& name : outputs)
      d.output(name, "1", "One.", [](const Named&) -> Real { return 1; });
  }
  bool flag = false;
};

TEST(Plugin, NamesThatNoSceneCanSayAreErrors) {
  const auto said = [](std::vector<std::string> attributes, std::vector<std::string> outputs) {
    Named::attributes = std::move(attributes), Named::outputs = std::move(outputs);
    PluginHeader header = good_header();
    header.enrol = [](Registry& r) { r.component<Named>("Named"); };
    Registry r;
    Diagnostics d;
    const bool is_taken = enrol_plugin(r, header, d);
    EXPECT_EQ(is_taken, d.ok());
    return d.ok() ? std::string() : d.all().front().message;
  };
  EXPECT_EQ(said({"young", "young_2"}, {"young"}), "");
  EXPECT_NE(said({"young", "young"}, {}).find("'young' of Named, twice"), std::string::npos);
  EXPECT_NE(said({}, {"f", "f"}).find("'f' of Named, twice"), std::string::npos);
  EXPECT_NE(said({"name"}, {}).find("which every component has"), std::string::npos);
  EXPECT_NE(said({"two words"}, {}).find("expected letters"), std::string::npos);
}

TEST(Plugin, ClashingNamesAreErrorsAndTheFirstHolds) {
  Registry r;
  r.component<CubeBox>("Ball");
  Diagnostics d;
  EXPECT_FALSE(enrol_plugin(r, good_header(), d));
  EXPECT_EQ(d.exit_code(), 6);
  EXPECT_NE(d.all().front().message.find("offers the component Ball, which plugin 'core' has"),
            std::string::npos);
  EXPECT_EQ(r.find("Ball")->summary, "A cube.");
}

TEST(Plugin, AnExceptionWhileEnrollingIsAnError) {
  Registry r;
  Diagnostics d;
  PluginHeader h = good_header();
  h.enrol = enrol_throwing;
  EXPECT_FALSE(enrol_plugin(r, h, d));
  EXPECT_NE(d.all().front().message.find("failed while enrolling: no memory of it"),
            std::string::npos);
}

TEST(Registry, SortsByPluginThenName) {
  Registry r;
  r.component<Rod>("Rod");
  r.component<Ball>("Ball");
  r.begin_plugin("alpha");
  r.component<CubeBox>("CubeBox");
  r.end_plugin();
  std::string order;
  for (const ComponentInfo* info : r.components()) order += info->plugin + '.' + info->name + ' ';
  EXPECT_EQ(order, "alpha.CubeBox core.Ball core.Rod ");
}

class PluginFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("sutura_plugin_tests_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string load_error(const std::string& name) {
    Registry r;
    Diagnostics d;
    EXPECT_FALSE(load_plugin(r, name, {folder_.string()}, {"s.xml", 3}, d));
    EXPECT_EQ(d.exit_code(), 6);
    EXPECT_EQ(d.all().front().location.line, 3);
    return d.all().front().message;
  }
  fs::path folder_;
};

TEST_F(PluginFiles, MissingOnesNameTheNearest) {
  std::ofstream(folder_ / "libsutura_thread.so") << "x";
  const std::string says = load_error("thraed");
  EXPECT_NE(says.find("did you mean 'thread'?"), std::string::npos) << says;
  EXPECT_NE(says.find(folder_.string()), std::string::npos) << says;
}

TEST_F(PluginFiles, WhatIsNoLibraryIsRefused) {
  std::ofstream(folder_ / "libsutura_fake.so") << "this is no library";
  EXPECT_NE(load_error("fake").find("cannot be loaded"), std::string::npos);
}

TEST_F(PluginFiles, ALibraryWithoutTheSymbolIsRefused) {
  // Any shared library will do; the one under test is at hand.
  const auto folders = default_plugin_directories();
  const fs::path library = fs::path(folders.back()).parent_path() / "libsutura.so";
  ASSERT_TRUE(fs::exists(library)) << library;
  fs::create_symlink(library, folder_ / "libsutura_other.so");
  EXPECT_NE(load_error("other").find("exports no sutura_plugin_other"), std::string::npos);
}

TEST_F(PluginFiles, NamesThatAreNoNamesNeverReachTheFileSystem) {
  for (const char* name : {"", "../../evil", "a/b", "A", "a b", "a.b"})
    EXPECT_NE(load_error(name).find("cannot be the name of a plugin"), std::string::npos) << name;
}

TEST_F(PluginFiles, PathVariableComesFirst) {
  const char* before = std::getenv("SUTURA_PLUGIN_PATH");
  const std::string saved = before ? before : "";
  ::setenv("SUTURA_PLUGIN_PATH", "/first::/second", 1);
  const auto folders = default_plugin_directories();
  if (before)
    ::setenv("SUTURA_PLUGIN_PATH", saved.c_str(), 1);
  else
    ::unsetenv("SUTURA_PLUGIN_PATH");
  ASSERT_EQ(folders.size(), 3u);
  EXPECT_EQ(folders[0], "/first");
  EXPECT_EQ(folders[1], "/second");
  EXPECT_EQ(fs::path(folders[2]).filename(), "sutura");
}

TEST(Plugin, SceneSaysWhereAMissingPluginWasNamed) {
  const auto l = load("\n<plugin name='thraed'/><Thread/>");
  EXPECT_FALSE(l->scene);
  EXPECT_EQ(l->diagnostics.errors(), 1u) << l->text();  // nothing said of <Thread>
  EXPECT_EQ(l->diagnostics.exit_code(), 6);
  EXPECT_EQ(l->diagnostics.all().front().location.line, 3);
}

}  // namespace
}  // namespace sutura::toys
