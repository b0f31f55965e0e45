// What docs/command.md promises: exit codes, how long a run is, and that files survive a bad end.
#include <gtest/gtest.h>

#include <algorithm>

#include "house/command.h"

namespace sutura::house {
namespace {

namespace fs = std::filesystem;

const std::string probe = std::string(SUTURA_SOURCE_DIR) + "/scenes/components/CsvProbe.xml";

class CommandLine : public testing::Test {
 protected:
  std::string scene(const std::string& text) {
    const fs::path file = folder_.path() / "scene.xml";
    std::ofstream(file) << text;
    return file.string();
  }
  std::string output() const { return " --output '" + (folder_.path() / "out").string() + "'"; }
  std::string csv() const { return read_text(folder_.path() / "out/probe.csv"); }
  TemporaryFolder folder_{"command_line"};
};

std::ptrdiff_t lines(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n');
}

TEST_F(CommandLine, UsageErrorsAreOne) {
  const std::string file = scene("<sutura version=\"1\"><GaussSeidel/></sutura>");
  EXPECT_EQ(command("--version").code, 0);
  EXPECT_EQ(command("--help").code, 0);
  EXPECT_EQ(command("").code, 1);
  EXPECT_EQ(command("fly").code, 1);
  EXPECT_EQ(command("run").code, 1);
  const Outcome how_long = command("run " + file);
  EXPECT_EQ(how_long.code, 1);
  EXPECT_NE(how_long.text.find("how long?"), std::string::npos);
  EXPECT_EQ(command("run " + file + " --steps 0").code, 1);
  EXPECT_EQ(command("run " + file + " --steps x").code, 1);
  EXPECT_EQ(command("run " + file + " --steps 1 --duration 1").code, 1);
  EXPECT_EQ(command("run " + file + " --duration '1 m'").code, 1);
  EXPECT_EQ(command("run " + file + " --steps 1 --set .dt").code, 1);
  EXPECT_EQ(command("describe NoSuchThing").code, 1);
}

TEST_F(CommandLine, DurationsBecomeSteps) {
  const std::string file = scene("<sutura version=\"1\" dt=\"20 ms\" duration=\"0.3 s\"/>");
  const auto says = [&](const std::string& options, const std::string& what) {
    const Outcome out = command("run " + file + options);
    EXPECT_EQ(out.code, 0) << out.text;
    EXPECT_NE(out.text.find(what), std::string::npos) << out.text;
  };
  says("", ": 15 steps, 0.3 s simulated");
  says(" --steps 7", ": 7 steps, 0.14 s simulated");
  says(" --duration '0.25 s' --set '.dt=10 ms'", ": 25 steps, 0.25 s simulated");
  says(" --duration '0.25 s'", ": 13 steps, 0.26 s simulated");  // the first step past the end
}

TEST_F(CommandLine, ResultsGoToTheOutputFolder) {
  const Outcome out = command("run " + probe + " --steps 5" + output());
  EXPECT_EQ(out.code, 0) << out.text;
  EXPECT_EQ(lines(csv()), 7);  // header, start, five steps
}

// In the folder of the scene: its path has no folder in it.
TEST_F(CommandLine, ASceneInTheCurrentFolderFindsItsFiles) {
  const Outcome out =
      command("check TetMesh.xml", "cd '" SUTURA_SOURCE_DIR "/scenes/components' && ");
  EXPECT_EQ(out.code, 0) << out.text;
}

TEST_F(CommandLine, ARunThatMissesItsTolerancesIsFiveUnlessLenient) {
  const std::string run = "run '" SUTURA_SOURCE_DIR
                          "/scenes/components/SutureThread.xml' --steps 2 --set .tolerance=1e-12 "
                          "--set .passes=1 --set .substeps=1" +
                          output();
  const Outcome out = command(run);
  EXPECT_EQ(out.code, 5) << out.text;
  EXPECT_NE(out.text.find("--lenient"), std::string::npos) << out.text;
  EXPECT_EQ(command(run + " --lenient").code, 0);
}

TEST_F(CommandLine, ARunThatGoesOnKnowsWhatWasMissedBefore) {
  const std::string hasty = "run '" SUTURA_SOURCE_DIR
                            "/scenes/components/SutureThread.xml' --set .tolerance=1e-12 "
                            "--set .passes=1 --set .substeps=1 --set '.dt=10 ms'" +
                            output();
  EXPECT_EQ(command(hasty + " --steps 4 --checkpoint-every 1us").code, 5);
  const std::string state = (folder_.path() / "out/checkpoint.sutura").string();
  const Outcome on = command(hasty + " --steps 6 --resume '" + state + "'");
  EXPECT_EQ(on.code, 5) << on.text;
  EXPECT_NE(on.text.find("MISSED BEFORE: 4 of the 4 steps"), std::string::npos) << on.text;
  EXPECT_NE(on.text.find("6 steps are less accurate"), std::string::npos) << on.text;
  EXPECT_NE(on.text.find(": 2 steps, 0.02 s simulated"), std::string::npos) << on.text;
}

TEST_F(CommandLine, WhatCannotBePrintedIsThree) {
  EXPECT_EQ(command("describe --xsd > /dev/full").code, 3);
  EXPECT_EQ(command("check '" + probe + "' > /dev/full").code, 3);
}

TEST_F(CommandLine, AnFmuThatCannotBeWrittenLeavesTheOneBefore) {
  const fs::path file = folder_.path() / "model.fmu";
  std::ofstream(file) << "the one before";
  fs::create_directory(file.string() + ".part");  // in the way of what is written first
  const Outcome out = command("fmu '" + probe + "' --output '" + file.string() + "'");
  EXPECT_EQ(out.code, 3);
  EXPECT_NE(out.text.find("Is a directory"), std::string::npos) << out.text;
  EXPECT_EQ(read_text(file), "the one before");
}

TEST_F(CommandLine, CheckWritesNothing) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_.path());
  EXPECT_EQ(command("check " + probe).code, 0);
  fs::current_path(before);
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(CommandLine, AFolderThatCannotBeWrittenIsThree) {
  std::ofstream(folder_.path() / "out") << "a file where the folder should be";
  const Outcome out = command("run " + probe + " --steps 5" + output());
  EXPECT_EQ(out.code, 3) << out.text;
}

TEST_F(CommandLine, DivergenceIsFourAndLosesNothing) {
  // A gravity and a step whose product is no number any more.
  const std::string file = scene(
      "<sutura version=\"1\" dt=\"10 s\" gravity=\"0 0 -1e308\" duration=\"100 s\">"
      "<plugin name=\"tissue\"/><plugin name=\"output\"/>"
      "<TetMesh file=\"" SUTURA_SOURCE_DIR
      "/scenes/meshes/block.msh\" unit=\"mm\"/>"
      "<Tissue/><CsvProbe columns=\"/tissue.lowest\"/></sutura>");
  const Outcome out = command("run " + file + output());
  EXPECT_EQ(out.code, 4) << out.text;
  EXPECT_NE(out.text.find("diverged: the state is no longer finite"), std::string::npos)
      << out.text;
  EXPECT_GE(lines(csv()), 2);
  EXPECT_TRUE(csv().ends_with('\n'));
}

TEST_F(CommandLine, FilesOutsideOfTheOutputFolderNeedLeave) {
  const std::string file = scene(
      "<sutura version=\"1\"><plugin name=\"tools\"/><plugin name=\"output\"/>"
      "<Track times=\"0\"/><CsvProbe columns=\"/track.position\" file=\"../outside.csv\"/>"
      "</sutura>");
  const fs::path outside = folder_.path() / "outside.csv";
  EXPECT_EQ(command("check " + file).code, 2);
  EXPECT_EQ(command("run " + file + " --steps 1" + output()).code, 2);
  EXPECT_FALSE(fs::exists(outside));
  EXPECT_EQ(command("check --allow-outside " + file).code, 0);
  const Outcome out = command("run --allow-outside " + file + " --steps 1" + output());
  EXPECT_EQ(out.code, 0) << out.text;
  EXPECT_TRUE(fs::exists(outside));
}

TEST_F(CommandLine, OneRunOwnsItsFolder) {
  EXPECT_EQ(command("run " + probe + " --steps 3" + output()).code, 0);
  const Outcome busy =
      command("run " + probe + " --steps 3" + output(),
              "flock --exclusive '" + (folder_.path() / "out/.sutura_files").string() + "' ");
  EXPECT_EQ(busy.code, 3) << busy.text;
  EXPECT_NE(busy.text.find("another run is writing to"), std::string::npos) << busy.text;
}

TEST_F(CommandLine, APluginThatIsCutShortIsSix) {
  const fs::path plugin = folder_.path() / "libsutura_cut.so";
  fs::copy_file(SUTURA_BINARY_DIR "/lib/sutura/libsutura_tools.so", plugin);
  const std::string file = scene("<sutura version=\"1\"><plugin name=\"cut\"/></sutura>");
  for (const int size : {0, 30, 1000, 20000, 60000}) {
    fs::resize_file(plugin, static_cast<std::uintmax_t>(size));
    const Outcome out =
        command("check " + file + " --plugin-path '" + folder_.path().string() + "'");
    EXPECT_EQ(out.code, 6) << size << ": " << out.text;
    EXPECT_NE(out.text.find("plugin 'cut' cannot be loaded"), std::string::npos) << out.text;
  }
}

// Five hundred times its weight crushes the block: the summary counts the steps and shows the
// first, and the command says that they are not what was asked for.
TEST_F(CommandLine, TheSummarySaysWhatWentWrong) {
  const std::string block =
      "run " SUTURA_SOURCE_DIR "/scenes/components/DirectSolver.xml --steps 3" + output();
  EXPECT_EQ(command(block).text.find("FAULT"), std::string::npos);
  const Outcome out = command(block + " --set .gravity='0 0 -5000'");
  EXPECT_EQ(out.code, 5) << out.text;
  EXPECT_NE(out.text.find("FAULT in 3 of 3 steps, first in step 1: /tissue: "), std::string::npos)
      << out.text;
  EXPECT_NE(out.text.find("tetrahedra are turned inside out"), std::string::npos) << out.text;
}

// Blades beside the thread: said once, and the run is as good as any.
TEST_F(CommandLine, TheSummarySaysWhatClosedOnNothing) {
  const std::string cut =
      "run " SUTURA_SOURCE_DIR "/scenes/components/Scissors.xml --duration 0.2" + output();
  EXPECT_EQ(command(cut).text.find("note: "), std::string::npos);
  const Outcome out = command(cut + " --set /scissors.centre='50 0 0 mm'");
  EXPECT_EQ(out.code, 0) << out.text;
  EXPECT_NE(out.text.find("  note: /scissors: closed at "), std::string::npos) << out.text;
}

// A thread that falls over its clamped beginning, in quarters of steps: each part of a step says
// what the others say.
TEST_F(CommandLine, ANoteOfADividedStepCountsOnce) {
  const std::string file = scene(
      "<sutura version='1' dt='20 ms' time_tolerance='0.13 mm' gravity='0 0 -9.81'>"
      "<plugin name='thread'/><plugin name='tools'/>"
      "<SutureThread needle_length='0' thread_length='100 mm' thread_beams='2' "
      "thread_diameter='20 um' thread_young='2 GPa'/>"
      "<Track times='0 0.1 s' centre='0 0 0' rotations='0 0 0  0 2.5 0 rad'/><Grasper at='0'/>"
      "</sutura>");
  const Outcome out = command("run " + file + " --steps 10" + output());
  EXPECT_NE(out.text.find("steps divided"), std::string::npos) << out.text;
  const std::size_t note = out.text.find("note in ");
  ASSERT_NE(note, std::string::npos) << out.text;
  EXPECT_LE(std::stoi(out.text.substr(note + 8)), 10) << out.text;
}

TEST_F(CommandLine, InterruptEndsTheStepAndClosesFiles) {
  const Outcome out = command("run " + probe + " --steps 1000000000" + output(),
                              "timeout --foreground --preserve-status --signal=INT 1 ");
  EXPECT_EQ(out.code, 130) << out.text;
  EXPECT_NE(out.text.find(" s simulated in "), std::string::npos)
      << out.text;  // the summary is there
  EXPECT_GE(lines(csv()), 2);
  EXPECT_TRUE(csv().ends_with('\n'));
}

TEST_F(CommandLine, NoProgressWithoutATerminal) {
  const Outcome out = command("run " + probe + " --steps 5" + output());
  EXPECT_EQ(out.text.find('\r'), std::string::npos);
}

TEST_F(CommandLine, PluginFolders) {
  const std::string file =
      scene("<sutura version=\"1\" duration=\"1 s\"><plugin name=\"tools\"/></sutura>");
  EXPECT_EQ(command("check " + file).code, 0);
  EXPECT_EQ(command("check " + file + " --plugin-path /nowhere").code,
            0);  // the default still holds
  const std::string other = scene("<sutura version=\"1\"><plugin name=\"nonesuch\"/></sutura>");
  const Outcome out = command("check " + other + " --plugin-path /nowhere");
  EXPECT_EQ(out.code, 6);
  EXPECT_NE(out.text.find("(/nowhere, "), std::string::npos) << out.text;
}

TEST_F(CommandLine, DescribeKnowsEveryPlugin) {
  const Outcome index = command("describe");
  EXPECT_EQ(index.code, 0);
  for (const char* name :
       {"GaussSeidel", "SutureThread", "Tissue", "Puncture", "Grasper", "CsvProbe"})
    EXPECT_NE(index.text.find(name), std::string::npos) << name;
  const Outcome one = command("describe Tissue");
  EXPECT_NE(one.text.find("young: real between 0.001 and 1e+15 Pa; default "), std::string::npos)
      << one.text;
}

}  // namespace
}  // namespace sutura::house
