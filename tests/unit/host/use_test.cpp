// The C API as a host uses it.
#include <cmath>
#include <cstring>
#include <fstream>

#include "house/command.h"
#include "unit/host/loaded.h"

namespace sutura::host_tests {
namespace {

TEST(Use, AHeldThreadFollowsItsTool) {
  const sutura_simulation s = load_text(held_thread);
  sutura_tool tool = 0;
  sutura_output target = 0, force = 0;
  ASSERT_EQ(sutura_find_tool(s, "/track", &tool), SUTURA_OK) << sutura_error();
  ASSERT_EQ(sutura_find_output(s, "/grasper.target", &target), SUTURA_OK) << sutura_error();
  ASSERT_EQ(sutura_find_output(s, "/grasper.force", &force), SUTURA_OK) << sutura_error();
  ASSERT_EQ(sutura_step(s, 1), SUTURA_OK) << sutura_error();
  double before[3], after[3], pull[3], pose[7] = {0.001, 0, 0.002, 1, 0, 0, 0}, back[7];
  ASSERT_EQ(sutura_get_output(target, before, 3), SUTURA_OK);
  ASSERT_EQ(sutura_set_pose(tool, pose), SUTURA_OK) << sutura_error();
  ASSERT_EQ(sutura_step(s, 1), SUTURA_OK) << sutura_error();
  ASSERT_EQ(sutura_get_output(target, after, 3), SUTURA_OK);
  ASSERT_EQ(sutura_get_pose(tool, back), SUTURA_OK);
  for (int i = 0; i < 7; ++i) EXPECT_DOUBLE_EQ(back[i], pose[i]);
  constexpr double rounding = 1e-15;  // m, of sums of centimetres
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(after[i] - before[i], pose[i], rounding);

  // After half a second at rest the jaws bear the weight of the thread (and of nothing else).
  ASSERT_EQ(sutura_step(s, 200), SUTURA_OK) << sutura_error();
  ASSERT_EQ(sutura_get_output(force, pull, 3), SUTURA_OK);
  EXPECT_GT(pull[2], 0);
  sutura_report report{};
  report.struct_size = sizeof report;
  ASSERT_EQ(sutura_get_report(s, &report), SUTURA_OK);
  EXPECT_EQ(report.step, 202);
  EXPECT_DOUBLE_EQ(report.time, 202 * 0.005);
  EXPECT_EQ(report.dt, 0.005);
  EXPECT_EQ(report.solved, 1);
  EXPECT_EQ(sutura_destroy(s), SUTURA_OK);
}

TEST(Use, InputsAreFoundSetAndChecked) {
  const sutura_simulation s = load_text(held_thread);
  std::size_t count = 0;
  ASSERT_EQ(sutura_input_count(s, &count), SUTURA_OK);
  EXPECT_EQ(count, 3u);  // position and rotation of the track, hold of the grasper
  for (std::size_t i = 0; i < count; ++i) {
    sutura_input input = 0, again = 0;
    sutura_value value{};
    value.struct_size = sizeof value;
    ASSERT_EQ(sutura_input_at(s, i, &input), SUTURA_OK);
    ASSERT_EQ(sutura_describe_input(input, &value), SUTURA_OK);
    EXPECT_TRUE(value.size == 1 || value.size == 3);
    EXPECT_NE(std::strlen(value.doc), 0u);
    ASSERT_EQ(sutura_find_input(s, (std::string(value.path) + "." + value.name).c_str(), &again),
              SUTURA_OK);
    EXPECT_EQ(again, input);
  }
  sutura_input hold = 0, position = 0;
  ASSERT_EQ(sutura_find_input(s, "/grasper.hold", &hold), SUTURA_OK);
  ASSERT_EQ(sutura_find_input(s, "/track.position", &position), SUTURA_OK);
  const double values[3] = {0, 2, std::nan("")};
  EXPECT_EQ(sutura_set_input(hold, values, 1), SUTURA_OK);
  EXPECT_EQ(sutura_set_input(hold, values + 1, 1), SUTURA_MISUSE);
  EXPECT_NE(std::string(sutura_error()).find("'hold' cannot be 2; expected 0 to 1"),
            std::string::npos)
      << sutura_error();
  EXPECT_EQ(sutura_set_input(hold, values, 3), SUTURA_MISUSE);
  EXPECT_EQ(sutura_set_input(position, values, 3), SUTURA_MISUSE);
  EXPECT_EQ(sutura_set_input(position, values, 1), SUTURA_MISUSE);

  // The thread was held against its weight; let go, it falls: h^2 g per step and step.
  sutura_output holding = 0;
  double is = 1;
  ASSERT_EQ(sutura_find_output(s, "/grasper.holding", &holding), SUTURA_OK);
  ASSERT_EQ(sutura_step(s, 1), SUTURA_OK) << sutura_error();
  ASSERT_EQ(sutura_get_output(holding, &is, 1), SUTURA_OK);
  EXPECT_EQ(is, 0);
  EXPECT_EQ(sutura_destroy(s), SUTURA_OK);
}

TEST(Use, GeometryIsThatOfTheLastStep) {
  const sutura_simulation s = load(scenes + "components/Tissue.xml");
  sutura_body body = 0;
  ASSERT_EQ(sutura_find_body(s, "/tissue", &body), SUTURA_OK) << sutura_error();
  sutura_geometry before{}, after{};
  before.struct_size = after.struct_size = sizeof before;
  ASSERT_EQ(sutura_get_geometry(body, &before), SUTURA_OK);
  EXPECT_STREQ(before.path, "/tissue");
  EXPECT_EQ(before.corners, 4u);
  ASSERT_GT(before.point_count, 0u);
  std::vector<double> points(before.points, before.points + 3 * before.point_count);
  for (std::size_t i = 0; i < 4 * before.cell_count; ++i) {
    ASSERT_GE(before.cells[i], 0);
    ASSERT_LT(before.cells[i], static_cast<std::int64_t>(before.point_count));
  }
  ASSERT_EQ(sutura_step(s, 2), SUTURA_OK) << sutura_error();
  ASSERT_EQ(sutura_get_geometry(body, &after), SUTURA_OK);
  EXPECT_EQ(after.topology, before.topology);
  ASSERT_EQ(after.point_count, points.size() / 3);
  EXPECT_NE(std::memcmp(after.points, points.data(), points.size() * sizeof(double)), 0);
  ASSERT_GT(after.field_count, 0u);
  for (std::size_t i = 0; i < after.field_count; ++i) {
    sutura_field field{};
    field.struct_size = sizeof field;
    ASSERT_EQ(sutura_get_field(body, i, &field), SUTURA_OK);
    EXPECT_EQ(field.count, field.on_cells != 0 ? after.cell_count : after.point_count)
        << field.name;
  }
  ASSERT_EQ(sutura_reset(s), SUTURA_OK);
  ASSERT_EQ(sutura_get_geometry(body, &after), SUTURA_OK);
  EXPECT_EQ(std::memcmp(after.points, points.data(), points.size() * sizeof(double)), 0);
  EXPECT_EQ(sutura_destroy(s), SUTURA_OK);
}

TEST(Use, AThreadThatIsResampledHasAnotherTopology) {
  // Held at one end it sags and bends there.
  const std::string text =
      "<sutura version='1' dt='5 ms'><plugin name='thread'/><plugin name='tools'/>"
      "<SutureThread name='suture' thread='4-0 polypropylene' thread_length='300 mm' "
      "sampling_angle='0.05 rad'/><Track times='0'/><Grasper/></sutura>";
  const sutura_simulation s = load_text(text);
  sutura_body body = 0;
  ASSERT_EQ(sutura_find_body(s, "/suture", &body), SUTURA_OK) << sutura_error();
  sutura_geometry g{};
  g.struct_size = sizeof g;
  std::uint64_t topology = 0;
  std::size_t points = 0;
  int resampled = 0;
  for (int i = 0; i < 60; ++i) {
    ASSERT_EQ(sutura_get_geometry(body, &g), SUTURA_OK);
    if (points != 0 && g.point_count != points) {
      EXPECT_NE(g.topology, topology);
      ++resampled;
    }
    topology = g.topology;
    points = g.point_count;
    ASSERT_EQ(sutura_step(s, 1), SUTURA_OK) << sutura_error();
  }
  EXPECT_GT(resampled, 0) << "the scene does not show what this test is about";
  EXPECT_EQ(sutura_destroy(s), SUTURA_OK);
}

TEST(Use, ErrorsOfASceneHaveFileLineAndNearestName) {
  const std::string text =
      "<sutura version=\"1\">\n<plugin name=\"thread\"/>\n<SutureThread thread_lenght='5 mm'/>\n"
      "<SutureThread name='b' thread_length='5 kPa'/>\n</sutura>";
  std::vector<std::string> told;
  sutura_options how = options();
  how.user = &told;
  how.message = [](void* user, std::int32_t severity, const char* sentence) {
    EXPECT_EQ(severity, SUTURA_ERROR);
    static_cast<std::vector<std::string>*>(user)->emplace_back(sentence);
  };
  sutura_simulation s = 7;
  EXPECT_EQ(sutura_load_text(text.data(), text.size(), "a.xml", nullptr, &how, &s),
            SUTURA_BAD_SCENE);
  EXPECT_EQ(s, 0u);
  ASSERT_EQ(sutura_diagnostic_count(), 2u);
  EXPECT_EQ(told.size(), 2u);
  sutura_diagnostic d{};
  d.struct_size = sizeof d;
  ASSERT_EQ(sutura_diagnostic_at(0, &d), SUTURA_OK);
  EXPECT_STREQ(d.file, "a.xml");
  EXPECT_EQ(d.line, 3);
  EXPECT_EQ(d.severity, SUTURA_ERROR);
  EXPECT_EQ(d.status, SUTURA_BAD_SCENE);
  EXPECT_NE(std::string(d.message).find("did you mean 'thread_length'?"), std::string::npos)
      << d.message;
  EXPECT_EQ(std::string(sutura_error()), told[0] + " (and 1 more)");
  EXPECT_EQ(sutura_diagnostic_at(2, &d), SUTURA_MISUSE);

  EXPECT_EQ(sutura_load("/nowhere/at/all.xml", nullptr, &s), SUTURA_BAD_FILE);
  const std::string plugin = "<sutura version='1'><plugin name='thred'/></sutura>";
  EXPECT_EQ(sutura_load_text(plugin.data(), plugin.size(), nullptr, nullptr, nullptr, &s),
            SUTURA_BAD_PLUGIN);
  EXPECT_NE(std::string(sutura_error()).find("did you mean 'thread'?"), std::string::npos)
      << sutura_error();
}

TEST(Use, SettingsReplaceAttributes) {
  sutura_options how = options();
  const char* settings[] = {".dt", "2 ms", "/suture.thread_length", "30 mm"};
  how.settings = settings;
  how.setting_count = 2;
  sutura_simulation s = 0;
  ASSERT_EQ(sutura_load_text(held_thread.data(), held_thread.size(), nullptr, nullptr, &how, &s),
            SUTURA_OK)
      << sutura_error();
  const char* xml = nullptr;
  ASSERT_EQ(sutura_write_scene(s, &xml), SUTURA_OK);
  EXPECT_NE(std::string(xml).find("thread_length=\"0.03 m\""), std::string::npos) << xml;
  EXPECT_NE(std::string(xml).find("dt=\"0.002 s\""), std::string::npos) << xml;
  sutura_component c{};
  c.struct_size = sizeof c;
  ASSERT_EQ(sutura_component_at(s, 0, &c), SUTURA_OK);
  EXPECT_STREQ(c.path, "/suture");
  EXPECT_STREQ(c.type, "SutureThread");
  EXPECT_STREQ(c.plugin, "thread");
  EXPECT_EQ(c.line, 3);
  EXPECT_EQ(sutura_destroy(s), SUTURA_OK);
}

TEST(Use, DivergenceIsSaidAndCanBeTakenBack) {
  const std::string text =
      "<sutura version='1' dt='10 s' gravity='0 0 -1e308'><plugin name='tissue'/>"
      "<TetMesh file='" SUTURA_SOURCE_DIR "/scenes/meshes/block.msh' unit='mm'/><Tissue/></sutura>";
  const sutura_simulation s = load_text(text);
  const std::vector<std::byte> before = state(s);
  EXPECT_EQ(sutura_step(s, 100), SUTURA_DIVERGED);
  EXPECT_NE(std::string(sutura_error()).find("no longer finite"), std::string::npos);
  EXPECT_EQ(sutura_step(s, 1), SUTURA_DIVERGED);
  EXPECT_EQ(sutura_reset(s), SUTURA_OK) << sutura_error();
  EXPECT_EQ(state(s), before);
  EXPECT_EQ(sutura_destroy(s), SUTURA_OK);
}

TEST(Use, RecordsWhatTheCommandRecords) {
  const house::TemporaryFolder folder("host_recording");
  const std::string scene = scenes + "components/CsvProbe.xml";
  const std::string ours = (folder.path() / "ours").string();
  const std::string theirs = (folder.path() / "theirs").string();
  sutura_options how = options();
  how.output = ours.c_str();
  const sutura_simulation s = load(scene, &how);
  ASSERT_EQ(sutura_start_recording(s), SUTURA_OK) << sutura_error();
  EXPECT_EQ(sutura_start_recording(s), SUTURA_MISUSE);
  EXPECT_EQ(sutura_reset(s), SUTURA_MISUSE) << "the files would not fit the state";
  ASSERT_EQ(sutura_step(s, 20), SUTURA_OK) << sutura_error();
  ASSERT_EQ(sutura_finish_recording(s), SUTURA_OK) << sutura_error();
  EXPECT_EQ(sutura_finish_recording(s), SUTURA_MISUSE);
  EXPECT_EQ(sutura_destroy(s), SUTURA_OK);
  const house::Outcome run =
      house::command("run '" + scene + "' --steps 20 --output '" + theirs + "'");
  ASSERT_EQ(run.code, 0) << run.text;
  const std::string csv = house::read_text(folder.path() / "theirs/probe.csv");
  EXPECT_GT(csv.size(), 100u);
  EXPECT_EQ(house::read_text(folder.path() / "ours/probe.csv"), csv);
}

// A host that takes many steps at once still hears of those before the last.
TEST(Use, StepsThatMissTheirTolerancesAreSaidAndCounted) {
  std::string text = held_thread;
  text.insert(text.find(" dt=") + 1, "tolerance='1e-12' passes='1' substeps='1' ");
  sutura_options how = options();
  int said = 0;
  how.user = &said;
  how.message = [](void* user, std::int32_t severity, const char* sentence) {
    *static_cast<int*>(user) +=
        severity == SUTURA_WARNING && std::strstr(sentence, "missed its tolerances") != nullptr;
  };
  sutura_simulation s = 0;
  ASSERT_EQ(sutura_load_text(text.data(), text.size(), "test.xml", nullptr, &how, &s), SUTURA_OK)
      << sutura_error();
  const std::vector<std::byte> start = state(s);
  ASSERT_EQ(sutura_step(s, 7), SUTURA_OK) << sutura_error();
  sutura_report report{};
  report.struct_size = sizeof report;
  ASSERT_EQ(sutura_get_report(s, &report), SUTURA_OK);
  EXPECT_EQ(report.missed, 7);
  EXPECT_EQ(said, 7);
  ASSERT_EQ(sutura_restore(s, start.data(), start.size()), SUTURA_OK) << sutura_error();
  ASSERT_EQ(sutura_get_report(s, &report), SUTURA_OK);
  EXPECT_EQ(report.missed, 0);
  EXPECT_EQ(sutura_destroy(s), SUTURA_OK);
}

}  // namespace
}  // namespace sutura::host_tests
