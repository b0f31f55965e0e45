// What a scene can say of needle, thread and pose, and what it is told when it says it wrongly.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

constexpr Real radius = 26e-3 / std::numbers::pi;

Vec3 tip(const TextRun& run) {
  return run.vector("/s", "tip_position");
}
Vec3 tip_direction(TextRun& run) {
  return -run.component<CurveBody>("/s").tangent(0, Configuration::current);
}

TEST(Words, ProductsFillInWhatTheSceneLeavesOut) {
  TextRun run("<SutureThread name=\"s\" needle=\"17 mm 3/8 circle\" thread=\"6-0 nylon\"/>");
  ASSERT_TRUE(run) << run.said();
  const auto& s = run.component<CurveBody>("/s");
  EXPECT_EQ(s.needle_length(), 17e-3);
  EXPECT_EQ(s.radius(1e-3), 0.25e-3);
  EXPECT_EQ(s.radius(30e-3), 0.0425e-3);
}

// Also where it says the very number that is the default.
TEST(Words, WhatTheSceneSaysWins) {
  TextRun run(
      "<SutureThread name=\"s\" needle=\"17 mm 3/8 circle\" needle_length=\"26 mm\" "
      "thread=\"6-0 nylon\" thread_diameter=\"0.175 mm\"/>");
  ASSERT_TRUE(run) << run.said();
  const auto& s = run.component<CurveBody>("/s");
  EXPECT_EQ(s.needle_length(), 26e-3);
  EXPECT_EQ(s.radius(1e-3), 0.25e-3);
  EXPECT_EQ(s.radius(30e-3), 0.0875e-3);
  // And it is written back, or the scene read again would be another one.
  const std::string written = write_scene(run.simulation().scene());
  EXPECT_NE(written.find("needle_length=\"0.026 m\""), std::string::npos) << written;
}

TEST(Words, BadProductsAreRefusedWithTheLine) {
  const TextRun run("<SutureThread name=\"s\" needle=\"17 mm 3/8\" thread=\"6-0 nylom\"/>");
  EXPECT_FALSE(run);
  EXPECT_NE(run.said().find("scene.xml:7"), std::string::npos) << run.said();
  EXPECT_NE(run.said().find("did you mean 'nylon'?"), std::string::npos) << run.said();
  EXPECT_NE(run.said().find("'26 mm 1/2 circle'"), std::string::npos) << run.said();
}

// What is given and means nothing is said; what means something is not.
TEST(Words, WhatHasNoEffectIsSaid) {
  const auto said = [](const std::string& elements) {
    const TextRun run("<plugin name='contact'/>" + elements);
    EXPECT_TRUE(run) << run.said();
    return run.said();
  };
  EXPECT_NE(said("<Tool shape='cylinder' radius='1 mm' length='5 mm' rounding='1 mm'/>")
                .find("'rounding' has no effect: the shape is a cylinder"),
            std::string::npos);
  EXPECT_NE(said("<SutureThread needle_length='0' needle_diameter='1 mm'/>")
                .find("'needle_diameter' has no effect: there is no needle"),
            std::string::npos);
  EXPECT_NE(said("<SutureThread clamp='end' settle='true' velocity='1 0 0 m/s'/>")
                .find("'velocity' has no effect: with 'settle' it begins at rest"),
            std::string::npos);
  EXPECT_EQ(said("<Tool shape='box' size='1 1 1 mm' rounding='0.1 mm'/>"
                 "<Tool name='ball' shape='sphere' radius='1 mm' centre='0 0 1 m'/>"
                 "<SutureThread needle_diameter='1 mm' thread_direction='1 0 0' "
                 "thread_bend_radius='9 mm' velocity='1 0 0 m/s'/>"),
            "");
}

TEST(Words, CentreAndAngle) {
  TextRun run(
      "<SutureThread name=\"s\" needle=\"26 mm 1/2 circle\" needle_centre=\"1 2 5 mm\" "
      "tip_angle=\"-90 deg\" plane_normal=\"0 -1 0\"/>");
  ASSERT_TRUE(run) << run.said();
  // Level with the centre, on the way down; with that normal it comes from minus x.
  EXPECT_LT((tip(run) - Vec3(1e-3 - radius, 2e-3, 5e-3)).norm(), 1e-12);
  EXPECT_LT((tip_direction(run) + Vec3::UnitZ()).norm(), 1e-9);
}

TEST(Words, EntryDirectionAndApproach) {
  TextRun run(
      "<SutureThread name=\"s\" needle=\"26 mm 1/2 circle\" entry=\"0 0 0\" tip_direction=\"0 0 "
      "-1\" approach=\"5 mm\" plane_normal=\"0 -1 0\"/>\n"
      "<Track about=\"s\" times=\"0 1 s\" turns=\"0 34.6154 deg\"/>\n"  // 5 mm / 26 mm of 180 deg
      "<Grasper at=\"20 mm\"/>");
  ASSERT_TRUE(run) << run.said();
  EXPECT_GT(tip(run).z(), 4e-3);
  run.run(1);
  // Six digits of the angle, and the grip's own softness.
  EXPECT_LT(tip(run).norm(), 1e-6);
  EXPECT_LT((tip_direction(run) + Vec3::UnitZ()).norm(), 1e-4);
}

TEST(Words, AStraightNeedleMayHaveAnEntry) {
  TextRun run(
      "<SutureThread name=\"s\" needle=\"26 mm straight\" entry=\"0 0 0\" approach=\"5 mm\" "
      "tip_direction=\"0 0 -2\" plane_normal=\"0 1 0\"/>");
  ASSERT_TRUE(run) << run.said();
  EXPECT_LT((tip(run) - Vec3(0, 0, 5e-3)).norm(), 1e-15);
}

struct Wrong {
  const char* scene;
  const char* words;
};

class Refused : public ::testing::TestWithParam<Wrong> {};

TEST_P(Refused, WithASentence) {
  const TextRun run(GetParam().scene);
  EXPECT_FALSE(run);
  EXPECT_NE(run.said().find(GetParam().words), std::string::npos) << run.said();
}

const char* const block =
    "<BlockMesh box=\"0 0 0 20 10 10 mm\" cells=\"4 2 2\"/><Tissue name=\"t\"/>"
    "<Attach box=\"0 0 0 20 10 0 mm\"/>";

INSTANTIATE_TEST_SUITE_P(
    Poses, Refused,
    ::testing::Values(
        Wrong{"<SutureThread tip=\"0 0 0\" needle_centre=\"0 0 0\" tip_angle=\"0\"/>",
              "the needle is placed twice"},
        Wrong{"<SutureThread tip=\"0 0 0\" entry=\"0 0 0\"/>", "the needle is placed twice"},
        Wrong{"<SutureThread needle_centre=\"0 0 0\" tip_angle=\"0\" tip_direction=\"1 0 0\"/>",
              "the needle is placed twice"},
        Wrong{"<SutureThread needle_centre=\"0 0 0\"/>", "go together"},
        Wrong{"<SutureThread approach=\"1 mm\"/>", "'approach' needs 'entry'"},
        Wrong{"<SutureThread needle_centre=\"0 0 0\" tip_angle=\"0\"/>",
              "plane of the needle is "
              "level"},
        Wrong{"<SutureThread needle=\"20 mm straight\" needle_centre=\"0 0 0\" tip_angle=\"0\" "
              "plane_normal=\"0 1 0\"/>",
              "straight needle has no centre"},
        Wrong{"<SutureThread thread_rest_file=\"nowhere.csv\"/>", "cannot read"},
        Wrong{"<SutureThread settle=\"true\"/>", "nothing holds this thread"}));

INSTANTIATE_TEST_SUITE_P(
    Tools, Refused,
    ::testing::Values(
        Wrong{"<Track times=\"0 1\" turns=\"0 1\"/>", "'turns' needs 'about'"},
        Wrong{"<SutureThread name=\"s\"/><Track about=\"s\" times=\"0 1\" turns=\"0 1 2\"/>",
              "'turns' has 3 numbers"},
        Wrong{"<SutureThread name=\"s\"/><Track about=\"s\" times=\"0\" turns=\"0\" "
              "rotations=\"0 0 0\"/>",
              "keys turn twice"},
        Wrong{"<SutureThread name=\"s\"/><Track about=\"s\" centre=\"0 0 0\" times=\"0\"/>",
              "'centre' and 'about'"},
        Wrong{"<SutureThread name=\"s\" needle_length=\"0\"/><Track about=\"s\" times=\"0\"/>",
              "has no needle"},
        Wrong{"<SutureThread name=\"s\" needle_angle=\"0\"/><Track about=\"s\" times=\"0\"/>",
              "the needle of 'about' is straight"},
        Wrong{"<SutureThread/><ThreadLoad at=\"9 m\" force=\"1 0 0\"/>", "m long"},
        Wrong{"<SutureThread/><ThreadLoad at=\"0\"/>", "neither 'force' nor 'moment'"},
        Wrong{"<SutureThread/><ThreadLoad at=\"0\" force=\"1 0 0\" times=\"0 1\"/>",
              "a factor for each time"},
        Wrong{"<SutureThread/><ThreadLoad at=\"0\" force=\"1 0 0\" times=\"1 1\" factors=\"1 2\"/>",
              "times must increase"},
        Wrong{"<SutureThread/><ThreadProbe at=\"9 m\"/>", "m long"}));

INSTANTIATE_TEST_SUITE_P(
    Blocks, Refused,
    ::testing::Values(
        Wrong{"<BlockMesh cells=\"1 1 1\"/>", "one of 'box' and 'corners'"},
        Wrong{"<BlockMesh box=\"0 0 0 1 1\" cells=\"1 1 1\"/>", "expected 6"},
        Wrong{"<BlockMesh corners=\"0 0 0\" cells=\"1 1 1\"/>", "expected 24"},
        Wrong{"<BlockMesh box=\"0 0 0 1 1 1\" cells=\"1 1\"/>", "expected 3"},
        Wrong{"<BlockMesh box=\"0 0 0 1 1 1\" cells=\"1.5 1 1\"/>", "whole numbers"},
        Wrong{"<BlockMesh box=\"0 0 0 1 1 1\" cells=\"1000 1000 1000\"/>", "more than 3 000 000"},
        Wrong{"<BlockMesh box=\"0 0 0 1 1 0\" cells=\"1 1 1\"/>", "'box' is flat"},
        Wrong{"<BlockMesh corners=\"0 0 0 1 0 0 0 1 0 1 1 0 0 0 0 1 0 0 0 1 0 1 1 0\" cells=\"1 1 "
              "1\"/>",
              "the block: "},
        Wrong{"<BlockMesh box=\"0 0 0 1 1 1\" cells=\"1 1 1\" holes=\"1 1\"/>", "6 for each hole"},
        Wrong{"<BlockMesh box=\"0 0 0 1 1 1\" cells=\"1 1 1\" cuts=\"1 1\"/>", "6 for each cut"},
        Wrong{"<BlockMesh box=\"0 0 0 1 1 1\" cells=\"2 2 2\" cuts=\"0 0 0 1 1 1\"/>",
              "is not flat"},
        Wrong{"<BlockMesh box=\"0 0 0 1 1 1\" cells=\"2 2 2\" cuts=\"0 0 0.6 1 1 0.6\"/>",
              "holds no side of a cell"},
        Wrong{"<BlockMesh box=\"0 0 0 4 4 4\" cells=\"4 4 4\" cuts=\"2 1 1 2 2 2\"/>",
              "open nothing"},
        Wrong{"<BlockMesh box=\"0 0 0 1 1 1\" cells=\"2 2 2\" holes=\"-1 -1 -1 2 2 "
              "2\"/>",
              "leave nothing"}));

/// A block with a bed, and one more component.
class RefusedOnABlock : public ::testing::TestWithParam<Wrong> {};

TEST_P(RefusedOnABlock, WithASentence) {
  const TextRun run(std::string(block) + GetParam().scene);
  EXPECT_FALSE(run);
  EXPECT_NE(run.said().find(GetParam().words), std::string::npos) << run.said();
}

INSTANTIATE_TEST_SUITE_P(
    Parts, RefusedOnABlock,
    ::testing::Values(
        Wrong{"<TissueLoad force=\"1 0 0\"/>", "one of 'box' and 'region'"},
        Wrong{"<TissueLoad box=\"0 0 0 1 1 1\"/>", "none of 'force'"},
        Wrong{"<TissueLoad box=\"0 0 0 1 1\" force=\"1 0 0\"/>", "expected 6"},
        Wrong{"<TissueLoad region=\"bone\" force=\"1 0 0\"/>", "no region 'bone'"},
        Wrong{"<TissueLoad box=\"2 2 2 3 3 3\" force=\"1 0 0\"/>", "no node of the tissue"},
        Wrong{"<TissueLoad box=\"5 5 5 5 5 5 mm\" pressure=\"1\"/>", "no face of the tissue's"},
        Wrong{"<TissueLoad box=\"5 5 5 5 5 5 mm\" moment=\"1 0 0\"/>", "three nodes"},
        Wrong{"<TissueLoad box=\"0 0 0 1 1 1\" force=\"1 0 0\" factors=\"1\"/>",
              "a factor for each time"},
        Wrong{"<TissueProbe/>", "one of 'point', 'box' and 'region'"},
        Wrong{"<TissueProbe point=\"0 0 0\" box=\"0 0 0 1 1 1\"/>", "both given"},
        Wrong{"<TissueProbe point=\"0 0 1\"/>", "not inside the tissue"},
        Wrong{"<TissueProbe box=\"2 2 2 3 3 3\"/>", "no tetrahedron"},
        Wrong{"<TissueProbe region=\"bone\"/>", "no region 'bone'"},
        Wrong{"<Attach name=\"b\" box=\"0 0 0 1 1 1\" directions=\"xw\"/>", "letters x, y and z"},
        Wrong{"<Attach name=\"b\" box=\"0 0 0 1 1 1\" directions=\"zz\"/>", "each once"},
        Wrong{"<Attach name=\"b\" box=\"0 0 0 1 1 1\" directions=\"\"/>", "is empty"},
        Wrong{"<Attach name=\"b\" region=\"bone\"/>", "no region 'bone'"}));

TEST(Words, ATissueThatNothingHoldsCannotSettle) {
  const TextRun run(
      "<BlockMesh box=\"0 0 0 20 10 10 mm\" cells=\"4 2 2\"/><Tissue settle=\"true\"/>",
      "gravity=\"0 0 -9.81\"");
  EXPECT_FALSE(run);
  EXPECT_NE(run.said().find("nothing holds this tissue"), std::string::npos) << run.said();
}

// It is attached, but not enough of it, or not in every direction.
TEST(Words, ATissueThatCannotSettleIsSaidToBeFree) {
  const auto said = [](const std::string& holes, const std::string& attach) {
    const TextRun run("<BlockMesh box=\"0 0 0 60 10 10 mm\" cells=\"6 2 2\" " + holes +
                          "/><Tissue settle=\"true\" poisson=\"0.3\"/><Attach " + attach + "/>",
                      "gravity=\"0 0 -9.81\"");
    EXPECT_FALSE(run);
    return run.said();
  };
  const std::string falls = said("", "box=\"0 0 0 60 10 0 mm\" directions=\"x\"");
  EXPECT_NE(falls.find("[/tissue] settle: no balance was found"), std::string::npos) << falls;
  EXPECT_NE(falls.find("it is free to move along y"), std::string::npos) << falls;
  const std::string part = said("holes=\"20 -1 -1 40 11 11 mm\"", "box=\"0 0 0 10 10 0 mm\"");
  EXPECT_NE(part.find("one of its 2 parts, with a node at 40 0 0 mm, is free to move in every "
                      "direction"),
            std::string::npos)
      << part;
}

// A mesh in the wrong unit passes by itself, and not beside a needle.
TEST(Words, ATissueFarFromTheSizeOfItsNeedleIsDoubted) {
  const auto doubts = [](const std::string& size, const std::string& needle = "26 mm") {
    const TextRun run("<BlockMesh box=\"0 0 0 " + size +
                      "\" cells=\"4 2 2\"/><Tissue poisson=\"0.3\"/>"
                      "<Attach nodes=\"0 1 2 3\"/><SutureThread name=\"s\" needle_length=\"" +
                      needle + "\"/>");
    EXPECT_TRUE(run) << run.said();
    return run.said().find("is the unit of one of them wrong?") != std::string::npos;
  };
  EXPECT_FALSE(doubts("50 30 10 mm"));
  EXPECT_TRUE(doubts("50 30 10 cm"));
  EXPECT_TRUE(doubts("3 2 1 mm"));
  EXPECT_FALSE(doubts("50 30 10 cm", "0"));  // there is no needle
}

// What lies on a tool or on a tissue that is attached does not fall.
TEST(Words, ATissueThatMayLieOnSomethingIsNotSaidToFall) {
  const auto says_so = [](const std::string& others) {
    const TextRun run(
        "<plugin name=\"contact\"/><node name=\"a\"><BlockMesh box=\"0 0 0 20 10 10 mm\" cells=\"4 "
        "2 2\"/>"
        "<Tissue poisson=\"0.3\"/></node>" +
            others,
        "gravity=\"0 0 -9.81\"");
    EXPECT_TRUE(run) << run.said();
    return run.said().find("[/a/tissue] nothing holds this tissue") != std::string::npos;
  };
  const std::string table = "<Tool centre=\"0 0 -1 mm\"/>";
  const std::string below =
      "<node name=\"b\"><BlockMesh box=\"0 0 -20 20 10 -1 mm\" cells=\"4 2 2\"/>"
      "<Tissue poisson=\"0.3\"/>";
  const std::string bed = "<Attach box=\"0 0 -20 20 10 -20 mm\"/></node>";
  const std::string touch = "<Contact first=\"/a/tissue\" second=\"/b/tissue\"/>";
  EXPECT_FALSE(says_so(table + "<Contact first=\"/a/tissue\" tool=\"/tool\"/>"));
  EXPECT_FALSE(says_so(below + bed + touch));
  const std::string stand = "<Contact name=\"other\" first=\"/b/tissue\" tool=\"/tool\"/>";
  const std::string deep = "<Tool centre=\"0 0 -21 mm\"/>";
  EXPECT_FALSE(says_so(deep + below + "</node>" + touch + stand));
  // Beside them, on one that falls too, or in touch with itself or with a thread, it falls.
  EXPECT_TRUE(says_so(table));
  EXPECT_TRUE(says_so(below + bed));
  EXPECT_TRUE(says_so(below + "</node>" + touch));
  EXPECT_TRUE(says_so("<Contact first=\"/a/tissue\"/>"));
  EXPECT_TRUE(says_so(table + "<SutureThread name=\"s\" entry=\"0 0 30 mm\"/>"
                              "<Contact first=\"/s\" tool=\"/tool\"/>"
                              "<Contact name=\"other\" first=\"/s\" "
                              "second=\"/a/tissue\"/>"));
}

TEST(Words, SizesThatAreMoreLikelyASlipOfTheUnitAreDoubted) {
  for (const char* slip : {"thread_length=\"50\"", "needle_length=\"17\"",
                           "needle_diameter=\"0.65\"", "thread_diameter=\"0.175\""}) {
    const TextRun run("<SutureThread " + std::string(slip) + "/>");
    EXPECT_NE(run.said().find("is the unit right?"), std::string::npos) << slip << run.said();
  }
  EXPECT_EQ(TextRun("<SutureThread thread_length=\"3 m\"/>").said(), "");
  const TextRun slow("<SutureThread/>", "dt=\"5\"");
  EXPECT_NE(slow.said().find("dt is 5 s"), std::string::npos) << slow.said();
}

// As it is drawn: a point three diameters long, then the wire, then the thread.
TEST(Words, ANeedleIsDrawnWithAPoint) {
  TextRun run(
      "<SutureThread needle_length=\"26 mm\" needle_diameter=\"0.65 mm\" "
      "needle_beams=\"40\" thread_diameter=\"0.2 mm\"/>");
  ASSERT_TRUE(run) << run.said();
  const BodyGeometry g = run.simulation().bodies()[0].body->geometry();
  const auto field = [&g](const std::string& name) {
    const auto found = std::find_if(g.fields.begin(), g.fields.end(),
                                    [&](const auto& f) { return f.name == name; });
    return found == g.fields.end() ? std::vector<Real>(g.points.size()) : found->values;
  };
  const std::vector<Real> s = field("abscissa [m]"), drawn = field("drawn radius [m]");
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Real wire = s[i] < 26e-3 - 1e-9 ? 0.325e-3 : 0.1e-3;
    EXPECT_NEAR(drawn[i], wire * std::min(1., s[i] / 1.95e-3), 1e-9) << s[i];
  }
  EXPECT_EQ(field("radius [m]").front(), 0.325e-3);  // as computed with
}

}  // namespace
}  // namespace sutura::testing
