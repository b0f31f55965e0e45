// Key frames from CSV: what is read, and where a malformed file is wrong.
#include "key_frame_file.h"

#include <gtest/gtest.h>

#include <fstream>
#include <numbers>

namespace sutura::tools {
namespace {

std::vector<KeyFrame> parse(std::string_view text) {
  std::vector<FileProblem> problems;
  std::vector<KeyFrame> keys = parse_key_frames(text, problems);
  for (const FileProblem& p : problems) ADD_FAILURE() << p.line << ": " << p.message;
  return keys;
}

TEST(KeyFrameFile, ColumnsInAnyOrderWithUnits) {
  const auto keys = parse(
      "# recorded at the bench\n"
      "ry [deg], t [ms], z [mm]\n"
      "\n"
      "0, 0, 1\n"
      "90, 500, -2.5\n");
  ASSERT_EQ(keys.size(), 2u);
  EXPECT_DOUBLE_EQ(keys[1].time, 0.5);
  EXPECT_DOUBLE_EQ(keys[1].position.z(), -2.5e-3);
  EXPECT_DOUBLE_EQ(keys[1].rotation.y(), std::numbers::pi / 2);
  EXPECT_EQ(keys[1].position.x(), 0);
}

TEST(KeyFrameFile, BareColumnsAreSi) {
  const auto keys = parse("t,x,rz\n0,0.25,1\n");
  ASSERT_EQ(keys.size(), 1u);
  EXPECT_EQ(keys[0].position, Vec3(0.25, 0, 0));
  EXPECT_EQ(keys[0].rotation, Vec3(0, 0, 1));
}

TEST(KeyFrameFile, SpreadsheetsFilesAreRead) {  // byte order mark, CR LF, no line break at the end
  const auto keys = parse("\xEF\xBB\xBFt [s],x [m]\r\n0,1\r\n1,2");
  ASSERT_EQ(keys.size(), 2u);
  EXPECT_EQ(keys[1].position.x(), 2);
}

struct Malformed {
  const char* text;
  int line;
  const char* says;
};

class MalformedKeyFrames : public testing::TestWithParam<Malformed> {};

TEST_P(MalformedKeyFrames, NamesTheLine) {
  std::vector<FileProblem> problems;
  EXPECT_TRUE(parse_key_frames(GetParam().text, problems).empty());
  ASSERT_FALSE(problems.empty());
  EXPECT_EQ(problems[0].line, GetParam().line);
  EXPECT_NE(problems[0].message.find(GetParam().says), std::string::npos) << problems[0].message;
}

INSTANTIATE_TEST_SUITE_P(
    KeyFrameFile, MalformedKeyFrames,
    testing::Values(
        Malformed{"", 0, "no header"}, Malformed{"# nothing\n", 0, "no header"},
        Malformed{"t,x\n", 0, "no key frame"}, Malformed{"x [mm]\n1\n", 1, "no column 't'"},
        Malformed{"t,w\n0,0\n", 1, "unknown column 'w'"}, Malformed{"t,t\n0,0\n", 1, "comes twice"},
        Malformed{"t [s,x\n0,0\n", 1, "name [unit]"}, Malformed{"t [mm],x\n0,0\n", 1, "t [mm]"},
        Malformed{"t,x [furlong]\n0,0\n", 1, "furlong"}, Malformed{"t,x\n0\n", 2, "1 fields"},
        Malformed{"t,x\n0,1,2\n", 2, "3 fields"}, Malformed{"t,x\n0,1\n1,1.5abc\n", 3, "'1.5abc'"},
        Malformed{"t,x\n0,nan\n", 2, "not a number"}, Malformed{"t,x\n0,inf\n", 2, "not a number"},
        Malformed{"t,x\n0,\n", 2, "not a number"}, Malformed{"t,x\n0,1e999\n", 2, "not a number"},
        Malformed{"t,x\n\n# pause\n1,0\n1,0\n", 5, "times must increase"},
        Malformed{"t,x\n1,0\n0.5,0\n", 3, "times must increase"}));

TEST(KeyFrameFile, CollectsProblemsUpToABound) {
  std::string text = "t,x\n";
  for (int i = 0; i < 1000; ++i) text += "a,b\n";
  std::vector<FileProblem> problems;
  parse_key_frames(text, problems);
  EXPECT_EQ(problems.size(), max_file_problems);
  EXPECT_EQ(problems[4].line, 6);
}

TEST(KeyFrameFile, MissingAndEmptyFilesAreProblems) {
  std::vector<FileProblem> problems;
  read_key_frames(testing::TempDir() + "/sutura_no_such_file.csv", problems);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_NE(problems[0].message.find("no such file"), std::string::npos);

  problems.clear();
  read_key_frames(testing::TempDir(), problems);  // a folder
  EXPECT_EQ(problems.size(), 1u);

  const std::string empty = testing::TempDir() + "/sutura_empty_track.csv";
  std::ofstream(empty).close();
  problems.clear();
  read_key_frames(empty, problems);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_NE(problems[0].message.find("no header"), std::string::npos);
}

}  // namespace
}  // namespace sutura::tools
