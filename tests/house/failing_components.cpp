// A component looks at its own errors only: beside any other that fails, each initialises as if it
// were alone, nothing crashes, and nobody complains but the one that failed.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <regex>
#include <set>

#include "house/command.h"
#include "sutura/plugin.h"
#include "sutura/simulation.h"

namespace sutura::house {
namespace {

namespace fs = std::filesystem;

const fs::path scenes = fs::path(SUTURA_SOURCE_DIR) / "scenes/components";

using Settings = std::vector<std::pair<std::string, std::string>>;

/// What makes a component fail when it is initialised. One that is not here cannot fail by itself;
/// as one that links to these it is left out in its turn.
const std::map<std::string, Settings> faults{
    {"AsyncPreconditioner", {{"lag", "soon"}}},
    {"Attach", {{"box", "9 9 9  9.1 9.1 9.1 m"}}},
    {"ConstraintTable", {{"file", "../outside.csv"}}},
    {"CsvProbe", {{"columns", "/nowhere.x"}, {"file", "there.csv"}}},
    {"Cutting", {{"regions", "nowhere"}, {"region_thresholds", "1 N"}}},
    {"GaussSeidel", {{"dump", "../outside"}}},
    {"Grasper", {{"at", "99 m"}}},
    {"Layer", {{"region", "nowhere"}}},
    {"Puncture", {{"regions", "nowhere"}, {"region_thresholds", "1 N"}}},
    {"SuturePath", {{"spacing", "1 um"}}},
    {"SutureThread", {{"tip_direction", "0 0 0"}}},
    {"TetMesh", {{"file", "nowhere.msh"}}},
    {"Track", {{"times", "2 1 s"}, {"positions", "0 0 0  0 0 1 mm"}}},
};

/// The component scene in a node; the paths in its attributes are led there.
struct Part {
  std::string plugins;
  std::string node;
};

Part part(const std::string& component, const std::string& node, bool with_recorders) {
  std::string text = read_text(scenes / (component + ".xml"));
  Part out;
  const std::regex plugin("<plugin [^>]*/>");
  for (std::sregex_iterator i(text.begin(), text.end(), plugin), end; i != end; ++i)
    out.plugins += i->str();
  text = std::regex_replace(text, plugin, "");
  const std::size_t root = text.find("<sutura");
  const std::size_t begin = text.find('>', root) + 1;
  text = text.substr(begin, text.rfind("</sutura>") - begin);
  if (!with_recorders) {  // they would fight over files with those of the other part
    for (const char* recorder : {"CsvProbe", "VtuRecorder", "ConstraintTable"})
      if (component != recorder)
        text = std::regex_replace(text, std::regex("<" + std::string(recorder) + "[^>]*/>"), "");
  }
  text = std::regex_replace(text, std::regex("([\"' ])/([a-z])"), "$1/" + node + "/$2");
  out.node = "<node name=\"" + node + "\">" + text + "</node>";
  return out;
}

std::vector<std::string> all() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(scenes))
    names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// The plugins of both, each once.
std::string scene_of(const Part& a, const Part& b) {
  std::set<std::string> plugins;
  const std::string text = a.plugins + b.plugins;
  const std::regex plugin("<plugin [^>]*/>");
  for (std::sregex_iterator i(text.begin(), text.end(), plugin), end; i != end; ++i)
    plugins.insert(i->str());
  std::string out = "<sutura version=\"1\">";
  for (const std::string& p : plugins) out += p;
  return out + a.node + b.node + "</sutura>";
}

class BesideOneThatFails : public testing::TestWithParam<std::string> {
 protected:
  BesideOneThatFails() { enrol_builtin(registry_); }

  std::unique_ptr<Scene> load(const std::string& text, const Settings& overrides) {
    Diagnostics diagnostics;
    auto scene = load_scene_text(text, "test.xml", scenes, registry_, diagnostics,
                                 {{SUTURA_BINARY_DIR "/lib/sutura"}, overrides});
    for (const Diagnostic& d : diagnostics.all()) ADD_FAILURE() << d.text() << '\n' << text;
    return scene;
  }

  /// Breaks every component of that type below `node` and expects no complaint but theirs.
  void fail(const std::string& text, const std::string& type, const std::string& node) {
    SCOPED_TRACE(type + " fails in " + text);
    const auto sound = load(text, {});
    ASSERT_TRUE(sound);
    Settings overrides;
    std::set<std::string> broken;
    for (const Component* c : sound->components()) {
      if (c->info().name != type || !c->path().starts_with(node)) continue;
      broken.insert(c->path());
      for (const auto& [attribute, value] : faults.at(type))
        overrides.emplace_back(c->path() + '.' + attribute, value);
    }
    if (broken.empty()) return;
    auto scene = load(text, overrides);
    ASSERT_TRUE(scene);
    Diagnostics diagnostics;
    EXPECT_FALSE(Simulation::compile(std::move(scene), "out", diagnostics));
    EXPECT_FALSE(diagnostics.ok());
    for (const Diagnostic& d : diagnostics.all()) {
      EXPECT_TRUE(d.severity == Severity::warning || broken.contains(d.node_path)) << d.text();
    }
  }

  Registry registry_;
};

TEST_P(BesideOneThatFails, IsInitialisedAsIfAlone) {
  for (const auto& [type, settings] : faults)
    fail(scene_of(part(type, "there", false), part(GetParam(), "here", true)), type, "/there/");
}

TEST_P(BesideOneThatFails, IsLeftOutIfItNeedsThatOne) {
  const Part none;
  for (const auto& [type, settings] : faults)
    fail(scene_of(none, part(GetParam(), "here", true)), type, "/here/");
}

INSTANTIATE_TEST_SUITE_P(Components, BesideOneThatFails, testing::ValuesIn(all()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace sutura::house
