// What is not described does not exist: every component of every plugin is described, has a
// smallest scene that runs, and a page of the reference that is current.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "base/unit_expression.h"
#include "house/command.h"
#include "scene/attributes.h"
#include "sutura/plugin.h"

namespace sutura::house {
namespace {

namespace fs = std::filesystem;

const fs::path source = SUTURA_SOURCE_DIR;
const fs::path scenes = source / "scenes/components";
const fs::path pages = source / "docs/components";

/// Every component of this build.
const Registry& everything() {
  static const std::unique_ptr<Registry> registry = [] {
    auto r = std::make_unique<Registry>();
    enrol_builtin(*r);
    const std::vector<std::string> folders{SUTURA_BINARY_DIR "/lib/sutura"};
    Diagnostics d;
    for (const std::string& name : available_plugins(folders))
      EXPECT_TRUE(load_plugin(*r, name, folders, {}, d)) << d.all().back().text();
    return r;
  }();
  return *registry;
}

std::vector<std::string> all() {
  std::vector<std::string> names;
  for (const ComponentInfo* info : everything().components()) names.push_back(info->name);
  return names;
}

bool is_sentence(const std::string& text) {
  return text.size() > 3 && text.ends_with('.') && text.front() != ' ';
}

bool is_snake_case(const std::string& text) {
  return !text.empty() && text.front() >= 'a' && text.front() <= 'z' &&
         std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
         });
}

/// Units in descriptions are coherent SI: what is stored needs no factor.
bool is_si(const std::string& text) {
  std::string error;
  const std::optional<Unit> unit = parse_unit(text, error);
  return unit && unit->power == 0 && unit->factor == 1;
}

class Described : public testing::TestWithParam<std::string> {
 protected:
  const ComponentInfo& info_ = *everything().find(GetParam());
};

TEST_P(Described, InFull) {
  const ComponentInfo& info = info_;
  EXPECT_TRUE(is_sentence(info.summary)) << info.summary;
  EXPECT_TRUE(info.name.front() >= 'A' && info.name.front() <= 'Z');
  std::set<std::string> names{"name"};
  for (const AttributeInfo& a : info.attributes) {
    SCOPED_TRACE(info.name + "." + a.name);
    EXPECT_TRUE(is_snake_case(a.name));
    EXPECT_TRUE(names.insert(a.name).second) << "described twice, or called 'name'";
    EXPECT_TRUE(is_sentence(a.doc)) << a.doc;
    const bool has_unit = a.type == AttributeType::real || a.type == AttributeType::vec3 ||
                          a.type == AttributeType::reals;
    EXPECT_EQ(is_si(a.unit), has_unit) << "unit '" << a.unit << "'";
    EXPECT_LE(a.range.low, a.range.high);
    EXPECT_EQ(a.choices.size() >= 2, a.type == AttributeType::choice);
  }
  for (const LinkInfo& l : info.links) {
    SCOPED_TRACE(info.name + "." + l.name);
    EXPECT_TRUE(is_snake_case(l.name));
    EXPECT_TRUE(names.insert(l.name).second);
    EXPECT_TRUE(is_sentence(l.doc)) << l.doc;
  }
  std::set<std::string> inputs;
  for (const InputInfo& i : info.inputs) {
    SCOPED_TRACE(info.name + "." + i.name);
    EXPECT_TRUE(is_snake_case(i.name));
    EXPECT_TRUE(inputs.insert(i.name).second);
    EXPECT_TRUE(is_sentence(i.doc)) << i.doc;
    EXPECT_TRUE(is_si(i.unit)) << i.unit;
    EXPECT_LE(i.range.low, i.range.high);
  }
  std::set<std::string> outputs;
  for (const OutputInfo& o : info.outputs) {
    SCOPED_TRACE(info.name + "." + o.name);
    EXPECT_TRUE(is_snake_case(o.name));
    EXPECT_TRUE(outputs.insert(o.name).second);
    EXPECT_TRUE(is_sentence(o.doc)) << o.doc;
    EXPECT_TRUE(o.unit.empty() || is_si(o.unit)) << o.unit;
  }
}

TEST_P(Described, DefaultsAreValuesThatASceneMayGive) {
  const ComponentInfo& info = info_;
  for (const AttributeInfo& a : info.attributes) {
    const std::unique_ptr<Component> fresh = info.create(), read = info.create();
    const std::string text = write_attribute(a, *fresh);
    if (a.is_required || text.empty()) continue;  // an empty text or list: left out
    std::string error;
    EXPECT_TRUE(read_attribute(a, *read, text, error))
        << info.name << '.' << a.name << ": " << error;
    EXPECT_EQ(write_attribute(a, *read), text);
  }
}

TEST_P(Described, HasASmallestSceneThatRuns) {
  const std::string name = GetParam();
  const fs::path scene = scenes / (name + ".xml");
  ASSERT_TRUE(fs::exists(scene)) << scene;
  EXPECT_NE(read_text(scene).find('<' + name), std::string::npos);
  const Outcome checked = command("check '" + scene.string() + "'");
  EXPECT_EQ(checked.code, 0) << checked.text;
  const TemporaryFolder out("component_" + name);
  const Outcome run =
      command("run '" + scene.string() + "' --steps 5 --output '" + out.path().string() + "'");
  EXPECT_EQ(run.code, 0) << run.text;
}

INSTANTIATE_TEST_SUITE_P(Components, Described, testing::ValuesIn(all()),
                         [](const auto& info) { return info.param; });

TEST(Reference, IsCurrent) {
  const TemporaryFolder fresh("reference");
  const Outcome out = command("describe --markdown '" + fresh.path().string() + "' --scenes '" +
                              scenes.string() + "'");
  ASSERT_EQ(out.code, 0) << out.text;
  std::set<std::string> files;
  for (const auto& entry : fs::directory_iterator(fresh.path()))
    files.insert(entry.path().filename().string());
  EXPECT_EQ(files.size(), all().size() + 1);
  for (const std::string& file : files)
    EXPECT_EQ(read_text(pages / file), read_text(fresh.path() / file))
        << file << " is stale: sutura describe --markdown docs/components";
  for (const auto& entry : fs::directory_iterator(pages))
    EXPECT_TRUE(files.contains(entry.path().filename().string())) << "left over: " << entry.path();
}

TEST(Reference, EverySceneShowsAComponent) {
  for (const auto& entry : fs::directory_iterator(scenes))
    EXPECT_TRUE(everything().find(entry.path().stem().string())) << entry.path();
}

TEST(Schema, ValidatesEveryScene) {
  ASSERT_EQ(std::system("command -v xmllint >/dev/null 2>&1"), 0)
      << "xmllint (Debian: libxml2-utils) is missing; ./dev test installs it";
  const TemporaryFolder folder("schema");
  const std::string schema = (folder.path() / "sutura.xsd").string();
  ASSERT_EQ(command("describe --xsd > '" + schema + "'").code, 0);
  const auto validates = [&](const fs::path& scene) {
    const std::string line = "xmllint --noout --schema '" + schema + "' '" + scene.string() + "'";
    return std::system((line + " >/dev/null 2>&1").c_str()) == 0;
  };
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(source / "scenes")) {
    if (entry.path().extension() != ".xml") continue;
    EXPECT_TRUE(validates(entry.path())) << entry.path();
    ++count;
  }
  EXPECT_GT(count, 0);
  // And it is no rubber stamp: what a schema can know, it refuses.
  const fs::path malformed = source / "tests/scenes/malformed";
  for (const char* name : {"component_misspelt", "attribute_misspelt", "attribute_required",
                           "attribute_choice", "attribute_flag", "attribute_nan", "node_no_name",
                           "root_no_version", "component_in_component"})
    EXPECT_FALSE(validates(malformed / (std::string(name) + ".xml"))) << name;
}

}  // namespace
}  // namespace sutura::house
