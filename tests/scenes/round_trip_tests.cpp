// Every scene of scenes/, written back and loaded again, runs to the same bits.
#include <gtest/gtest.h>

#include <algorithm>

#include "sutura/simulation.h"
#include "sutura/units.h"

namespace sutura {
namespace {

namespace fs = std::filesystem;

const fs::path folder = fs::path(SUTURA_SOURCE_DIR) / "scenes";

/// Below scenes/, without it.
std::vector<std::string> scenes() {
  std::vector<std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".xml")
      out.push_back(entry.path().lexically_relative(folder).string());
  std::sort(out.begin(), out.end());
  return out;
}

struct Text {
  std::string operator()(Real x) const { return format_real(x); }
  std::string operator()(const Vec3& v) const {
    return format_real(v.x()) + ' ' + format_real(v.y()) + ' ' + format_real(v.z());
  }
  std::string operator()(const std::string& s) const { return s; }
};

/// All outputs of all components after each of a few steps; format_real loses no bit.
std::string trace(std::unique_ptr<Scene> scene, Diagnostics& diagnostics,
                  std::string* compiled = nullptr) {
  constexpr int steps = 8;
  const auto simulation = Simulation::compile(std::move(scene), {}, diagnostics);
  if (!simulation) return {};
  if (compiled != nullptr) *compiled = write_scene(simulation->scene());
  std::string out;
  for (int i = 0; i < steps; ++i) {
    const StepReport& report = simulation->step();
    out += "step " + std::to_string(report.step) + " rows " + std::to_string(report.rows) + '\n';
    for (const Component* c : simulation->scene().components())
      for (const OutputInfo& o : c->info().outputs)
        out += c->path() + '.' + o.name + ' ' + std::visit(Text{}, o.read(*c)) + '\n';
    for (const auto& body : simulation->bodies())
      out += body.path + ' ' + format_real(body.body->energy()) + '\n';
  }
  return out;
}

class RoundTrip : public testing::TestWithParam<std::string> {};

TEST_P(RoundTrip, RunsToTheSameBits) {
  const fs::path file = folder / GetParam();
  const LoadOptions options{.plugin_directories = {SUTURA_BINARY_DIR "/lib/sutura"}};
  Registry registry;
  enrol_builtin(registry);
  Diagnostics diagnostics;
  auto first = load_scene(file, registry, diagnostics, options);
  ASSERT_TRUE(first) << (diagnostics.all().empty() ? "" : diagnostics.all().front().text());
  const std::string written = write_scene(*first);
  auto second =
      load_scene_text(written, "written.xml", file.parent_path(), registry, diagnostics, options);
  ASSERT_TRUE(second) << diagnostics.all().front().text() << '\n' << written;
  EXPECT_EQ(write_scene(*second), written);
  EXPECT_EQ(second->duration, first->duration);
  std::string compiled;
  const std::string a = trace(std::move(first), diagnostics, &compiled),
                    b = trace(std::move(second), diagnostics);
  EXPECT_TRUE(diagnostics.ok());
  EXPECT_FALSE(a.empty());
  EXPECT_EQ(a, b) << written;
  // What a host writes, once components have been initialised.
  auto third =
      load_scene_text(compiled, "written.xml", file.parent_path(), registry, diagnostics, options);
  ASSERT_TRUE(third) << diagnostics.all().front().text() << '\n' << compiled;
  EXPECT_EQ(trace(std::move(third), diagnostics), a) << compiled;
}

INSTANTIATE_TEST_SUITE_P(Scenes, RoundTrip, testing::ValuesIn(scenes()), [](const auto& info) {
  std::string name = info.param;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); },
      '_');
  return name;
});

}  // namespace
}  // namespace sutura
