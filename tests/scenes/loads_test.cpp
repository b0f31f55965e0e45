// Loads, supports, prescribed motion, settling, rest shapes and probes, against statics by hand.
#include <cmath>
#include <numbers>

#include "scenes/text_run.h"
#include "sutura/units.h"

namespace sutura::testing {
namespace {

// 20 x 10 x 10 mm, 2 g, on its bed.
const std::string block =
    "<BlockMesh box=\"0 0 0 20 10 10 mm\" cells=\"8 4 4\"/>"
    "<Tissue name=\"t\" young=\"20 kPa\" damping_mass=\"20 1/s\" settle=\"true\"/>"
    "<Attach name=\"bed\" box=\"0 0 0 20 10 0 mm\"/>";
constexpr Real weight = 2e-3 * 9.81;  // N

// Tolerance of a step: a thousandth of the forces at work.
constexpr Real step_tolerance = 2e-3;

TEST(Loads, TheBedHoldsWhatActsOnTheBlock) {
  TextRun run(block +
                  "<TissueLoad name=\"f\" box=\"0 0 10 20 10 10 mm\" force=\"0.01 0 0.02 N\"/>"
                  "<TissueLoad name=\"t2\" box=\"20 0 0 20 10 10 mm\" traction=\"0 50 0 Pa\"/>",
              "gravity=\"0 0 -9.81\"");
  ASSERT_TRUE(run) << run.said();
  run.run(0.05);
  EXPECT_NEAR(run.number("/f", "area"), 200e-6, 1e-12);
  EXPECT_NEAR(run.vector("/t2", "force").y(), 50 * 100e-6, 1e-12);
  const Vec3 expected = -Vec3(0.01, 50 * 100e-6, 0.02 - weight);
  EXPECT_LT((run.vector("/bed", "reaction") - expected).norm(), step_tolerance * weight);
}

// Pressure on a closed surface has no sum, whatever its shape; on one face it is p A.
TEST(Loads, PressureFollowsTheSurface) {
  TextRun run(block + "<TissueLoad name=\"all\" box=\"0 0 0 20 10 10 mm\" pressure=\"1 kPa\"/>" +
              "<TissueLoad name=\"top\" box=\"0 0 10 20 10 10 mm\" pressure=\"-100 Pa\"/>");
  ASSERT_TRUE(run) << run.said();
  run.simulation().step();
  EXPECT_LT(run.vector("/all", "force").norm(), 1e-12);
  // -100 Pa pulls outward on about 200 mm^2, which the squeeze has changed by some percent.
  EXPECT_NEAR(run.vector("/top", "force").z(), 0.02, 0.1 * 0.02);
}

// The same pressure all round has no moment, and what turns under it goes on as it did.
TEST(Loads, PressureAllRoundDoesNotTurnAFreeBlock) {
  for (const Real dt : {1e-3, 1e-2}) {
    TextRun run(
        "<BlockMesh box='0 0 0 20 10 10 mm' cells='6 3 3'/><Tissue young='100 kPa' poisson='0.3' "
        "spin='0 0 0.01 rad/s'/>"
        "<TissueLoad box='-1 -1 -1 21 11 11 mm' pressure='100 Pa'/>",
        "gravity='0 0 0' dt='" + format_real(dt) + " s'");
    ASSERT_TRUE(run) << run.said();
    const Real energy = run.number("/tissue", "kinetic_energy");
    run.run(1);
    // The pressure takes a thousandth off the block's width, and with it 0.2 % off its inertia.
    EXPECT_NEAR(run.number("/tissue", "kinetic_energy"), energy, 0.01 * energy) << dt;
  }
}

// What pressure holds squeezed stays at rest. A force that is a step late swings it.
TEST(Loads, UnderPressureABlockComesToRest) {
  for (const char* dt : {"2.5 ms", "10 ms", "40 ms"}) {
    TextRun run(
        "<BlockMesh box='-10 -10 0 10 10 20 mm' cells='6 6 6'/><Tissue young='10 kPa' "
        "poisson='0.3'/><Attach box='-10 -10 0 10 10 0 mm'/>"
        "<TissueLoad box='-10 -10 0 10 10 20 mm' pressure='1 kPa' times='0 0.5 s' factors='0 1'/>",
        std::string("gravity='0 0 0' dt='") + dt + "'");
    ASSERT_TRUE(run) << run.said();
    run.run(4);
    EXPECT_LT(run.number("/tissue", "kinetic_energy"), 1e-18) << dt;
  }
}

// A block on rollers stretches evenly, by s: its law (docs/theory/tissue.md) has the stress 3K (s -
// 1) at rest's area, 3K = E / (1 - 2 nu), which balances -p s^2. Beyond a tension of 3K / 4 nothing
// does.
TEST(Settling, ABlockUnderPressureTakesItsSizeOrIsRefused) {
  const auto block_under = [](const std::string& pressure) {
    return TextRun(
        "<BlockMesh box='0 0 0 10 10 10 mm' cells='4 4 4'/><Tissue young='10 kPa' poisson='0.3' "
        "settle='true'/><Attach box='0 0 0 0 10 10 mm' directions='x'/>"
        "<Attach name='y' box='0 0 0 10 0 10 mm' directions='y'/>"
        "<Attach name='z' box='0 0 0 10 10 0 mm' directions='z'/>"
        "<TissueLoad box='-50 -50 -50 50 50 50 mm' pressure='" +
        pressure + "'/><TissueProbe name='corner' point='10 10 10 mm'/>");
  };
  const Real modulus = 10e3 / (1 - 2 * 0.3);
  for (const Real p : {2e3, 500., -4e3, -6e3}) {
    TextRun run = block_under(format_real(p) + " Pa");
    ASSERT_TRUE(run) << run.said();
    const Real stretch = (std::sqrt(modulus * modulus + 4 * p * modulus) - modulus) / (2 * p);
    // To a millionth of the forces; near the largest tension that moves it a hundred times further.
    for (const Real u : run.vector("/corner", "displacement"))
      EXPECT_NEAR(u, 10e-3 * (stretch - 1), 1e-4 * 10e-3) << p;
  }
  for (const char* tension : {"-7 kPa", "-15 kPa"}) {
    TextRun run = block_under(tension);
    EXPECT_FALSE(run);
    EXPECT_NE(run.said().find("no balance was found"), std::string::npos) << run.said();
  }
}

// Pressure turns with what it bends: settled, a strip that it has bent by half of its length is at
// rest in the first step.
TEST(Settling, AStripThatPressureBendsIsAtRest) {
  TextRun run(
      "<BlockMesh box='0 0 0 40 10 4 mm' cells='16 4 2'/><Tissue young='10 kPa' poisson='0.3' "
      "settle='true' damping_stiffness='0.1 s'/><Attach box='0 0 0 0 10 4 mm'/>"
      "<TissueLoad box='0 0 0 40 10 0 mm' pressure='15 Pa'/>"
      "<TissueProbe name='end' point='40 5 2 mm'/>");
  ASSERT_TRUE(run) << run.said();
  const Vec3 bent = run.vector("/end", "displacement");
  EXPECT_GT(bent.norm(), 20e-3);
  run.run(0.1);
  // A millionth of the forces was left.
  EXPECT_LT((run.vector("/end", "displacement") - bent).norm(), 1e-6 * bent.norm());
}

TEST(Loads, AMomentHasNoForceAndItsOwnMoment) {
  TextRun run(block +
              "<TissueLoad name=\"m\" box=\"0 0 10 20 10 10 mm\" moment=\"0 1e-5 0 N m\"/>");
  ASSERT_TRUE(run) << run.said();
  run.simulation().step();
  EXPECT_LT(run.vector("/m", "force").norm(), 1e-15);
  Body& t = *run.simulation().bodies()[0].body;
  const VecX& load = t.load();
  const BodyGeometry g = t.geometry();
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < g.points.size(); ++i)
    sum += g.points[i].cross(Vec3(load.segment<3>(3 * static_cast<Index>(i))));
  // The load is that of the positions at the start of the step, which has moved little since.
  EXPECT_LT((sum - Vec3(0, 1e-5, 0)).norm(), 1e-3 * 1e-5);
}

TEST(Loads, FactorsFollowTheirTimes) {
  TextRun run(
      "<SutureThread name=\"s\" needle_length=\"0\" clamp=\"start\"/>"
      "<ThreadLoad name=\"l\" at=\"0.1\" force=\"1e-6 0 0\" times=\"0.1 0.2 s\" factors=\"0 2\"/>");
  ASSERT_TRUE(run) << run.said();
  run.run(0.1);
  EXPECT_EQ(run.number("/l", "factor"), 0);
  run.run(0.15);
  EXPECT_NEAR(run.number("/l", "factor"), 1, 1e-9);
  run.run(0.3);
  EXPECT_EQ(run.number("/l", "factor"), 2);
}

// The dead end load and the weight of a hanging thread are its tension, which is that of the beam's
// middle: half a beam of weight.
TEST(Loads, AHangingThreadBearsItsLoad) {
  TextRun run(
      "<SutureThread name=\"s\" needle_length=\"0\" thread=\"4-0 nylon\" thread_length=\"100 mm\" "
      "tip_direction=\"0 0 1\" plane_normal=\"0 1 0\" clamp=\"start\" settle=\"true\"/>"
      "<ThreadLoad at=\"100 mm\" force=\"0 0 -1 mN\"/>"
      "<ThreadProbe name=\"top\" at=\"0\"/><ThreadProbe name=\"end\" at=\"100 mm\"/>"
      "<EnergyProbe name=\"e\"/>",
      "gravity=\"0 0 -9.81\"");
  ASSERT_TRUE(run) << run.said();
  run.run(0.1);
  const Real per_metre = 27.42021338e-6 * 9.81;  // d01: 27.42 mg/m
  EXPECT_NEAR(run.number("/top", "tension"), 1e-3 + per_metre * 0.0995, 1e-6);
  EXPECT_LT((run.vector("/top", "force") - Vec3(0, 0, -1e-3 - per_metre * 0.0995)).norm(), 1e-6);
  // Stretch: (P L + w L^2 / 2) / EA, EA of d01.
  const Real EA = 48.10563751, stretch = (1e-3 * 0.1 + per_metre * 0.1 * 0.05) / EA;
  EXPECT_NEAR(-run.vector("/end", "displacement").z(), stretch, 1e-2 * stretch);
  EXPECT_NEAR(run.number("/e", "potential"), -per_metre * 0.1 * 0.05, 1e-4 * per_metre * 0.005);
}

// A needle that is bent by a load across its end bears that load at every section.
TEST(Loads, ABentNeedleBearsItsLoadAcrossItself) {
  TextRun run(
      "<SutureThread name=\"s\" needle_length=\"20 mm\" needle_angle=\"0\" thread_length=\"2 mm\" "
      "thread_beams=\"2\" tip_direction=\"-1 0 0\" plane_normal=\"0 1 0\" clamp=\"start\" "
      "settle=\"true\"/>"
      "<ThreadLoad at=\"20 mm\" force=\"0 0.01 -0.05 N\"/>"
      "<ThreadProbe name=\"first\" at=\"1 mm\"/><ThreadProbe name=\"last\" at=\"19 mm\"/>"
      "<ThreadProbe name=\"beyond\" at=\"21.5 mm\"/>");
  ASSERT_TRUE(run) << run.said();
  run.run(0.05);
  const Vec3 load(0, 0.01, -0.05);
  for (const char* section : {"/first", "/last"})
    EXPECT_LT((run.vector(section, "force") - load).norm(), step_tolerance * load.norm());
  EXPECT_LT(std::abs(run.number("/first", "tension")), step_tolerance * load.norm());
  EXPECT_LT(run.vector("/beyond", "force").norm(), step_tolerance * load.norm());
}

// Drawn from a straight start into its rest shape: with nothing but a clamp, it takes it.
TEST(Settling, AThreadTakesItsRestShape) {
  TextRun run(
      "<SutureThread name=\"s\" needle_length=\"0\" thread_length=\"50 mm\" thread_beams=\"50\" "
      "thread_rest_curvature=\"60 1/m\" thread_rest_torsion=\"30 1/m\" tip_direction=\"-1 0 0\" "
      "clamp=\"start\" settle=\"true\"/><ThreadProbe name=\"end\" at=\"50 mm\"/>");
  ASSERT_TRUE(run) << run.said();
  // The helix by hand: its chord after s.
  const Real w = std::hypot(60, 30), r = 60 / (w * w), b = 30 / (w * w), s = 0.05;
  const Real chord = std::hypot(2 * r * std::sin(w * s / 2), b * w * s);
  EXPECT_NEAR(run.vector("/end", "position").norm(), chord, 1e-4 * chord);
  EXPECT_LT(run.vector("/end", "displacement").norm(), 1e-6);
}

// Nodes that one support holds and another moves go with the one that moves, and that is said.
TEST(Supports, ThatContradictEachOtherAreNamed) {
  const std::string block =
      "<BlockMesh box='0 0 0  10 4 4 mm' cells='8 3 3'/><Tissue young='50 kPa'/>"
      "<Track name='m' times='0 0.1 s' positions='0 0 0  0 0 2 mm'/><Attach name='a' box='0 0 0  "
      "1.25 4 4 mm'/>";
  TextRun apart(block + "<Attach name='b' box='2.5 0 0  10 4 4 mm' motion='m'/>");
  EXPECT_EQ(apart.said().find("another Attach"), std::string::npos) << apart.said();
  TextRun both(block +
               "<Attach name='b' box='1.25 0 0  10 4 4 mm' motion='m'/>"
               "<TissueProbe name='shared' point='1.25 0 0 mm'/>");
  ASSERT_TRUE(both) << both.said();
  EXPECT_NE(both.said().find("16 of its nodes are held by another Attach"), std::string::npos)
      << both.said();
  both.run(0.2);
  EXPECT_NEAR(both.vector("/shared", "displacement").z(), 2e-3, 1e-12);
}

// What several hold is counted once: all together hold what the tissue is held with.
TEST(Supports, ThatOverlapShareTheirForce) {
  for (const char* second :
       {"<Attach name='b' box='0 0 0  2.5 4 1.5 mm'/>",
        "<Attach name='b' box='0 0 0  2.5 4 1.5 mm' directions='yz'/>",
        "<Track name='m' times='0'/><Attach name='b' box='0 0 0  2.5 4 1.5 mm' motion='m'/>"}) {
    TextRun run(
        std::string("<BlockMesh box='0 0 0  10 4 4 mm' cells='8 3 3'/><Tissue name='t' young='50 "
                    "kPa' damping_mass='50 1/s'/><Attach name='a' box='0 0 0  1.25 4 4 mm'/>") +
            second,
        "gravity='0 0 -9.81'");
    ASSERT_TRUE(run) << run.said();
    run.run(0.5);
    const Vec3 all = run.vector("/t", "reaction");
    EXPECT_NEAR(all.z(), 1000 * 160e-9 * 9.81, 2e-3 * all.z());
    EXPECT_LT((run.vector("/a", "reaction") + run.vector("/b", "reaction") - all).norm(),
              1e-12 * all.norm())
        << second;
  }
}

// A settled scene begins at rest and stays there.
TEST(Settling, WhatIsSettledStays) {
  TextRun run(block +
                  "<SutureThread name=\"s\" needle_length=\"0\" tip=\"0 0 30 mm\" "
                  "tip_direction=\"-1 0 0\" thread_length=\"50 mm\" settle=\"true\"/>"
                  "<Track times=\"0\"/><Grasper at=\"0\"/>"
                  "<TissueProbe name=\"top\" point=\"20 10 10 mm\"/>"
                  "<ThreadProbe name=\"end\" at=\"50 mm\"/>"
                  "<Distance from=\"/top\" to=\"/end\"/>",
              "gravity=\"0 0 -9.81\"");
  ASSERT_TRUE(run) << run.said();
  EXPECT_LT(run.vector("/end", "displacement").z(), -1e-3);  // it hangs
  EXPECT_LT(run.vector("/top", "displacement").z(), -1e-6);  // and sags
  const Vec3 end = run.vector("/end", "position"), top = run.vector("/top", "position");
  EXPECT_EQ(run.number("/distance", "distance"), (end - top).norm());
  run.run(0.5);
  EXPECT_LT((run.vector("/end", "position") - end).norm(), 1e-6);
  EXPECT_LT((run.vector("/top", "position") - top).norm(), 1e-8);
}

// A bed that moves as a whole carries the block along, and pushes it by m a.
TEST(Supports, AMovingAttachmentCarriesAndPushes) {
  TextRun run(
      "<BlockMesh box=\"0 0 0 20 10 10 mm\" cells=\"8 4 4\"/><Tissue name=\"t\" young=\"1 MPa\"/>"
      "<Track times=\"0 10 s\" positions=\"0 0 0  10 0 0 mm\"/>"
      "<Attach name=\"bed\" box=\"0 0 0 20 10 0 mm\" motion=\"/track\"/>"
      "<TissueProbe name=\"top\" point=\"10 5 10 mm\"/>");
  ASSERT_TRUE(run) << run.said();
  run.simulation().step();
  // From rest to 1 mm/s within the step: momentum is the time integral of the only force.
  EXPECT_NEAR(run.vector("/bed", "reaction").x() * 0.01, run.vector("/t", "momentum").x(),
              1e-2 * 2e-6);
  run.run(0.2);
  EXPECT_NEAR(run.vector("/top", "displacement").x(), 0.2e-3, 1e-6);
  EXPECT_LT(run.vector("/bed", "reaction").norm(), 1e-4);
}

TEST(Supports, ASlidingSupportLeavesTheOtherDirectionsFree) {
  TextRun run(
      "<BlockMesh box=\"0 0 0 20 10 10 mm\" cells=\"8 4 4\"/>"
      "<Tissue name=\"t\" young=\"20 kPa\" velocity=\"0.1 0 0 m/s\"/>"
      "<Attach name=\"table\" box=\"0 0 0 20 10 0 mm\" directions=\"z\"/>"
      "<TissueProbe name=\"low\" point=\"10 5 0 mm\"/>",
      "gravity=\"0 0 -9.81\"");
  ASSERT_TRUE(run) << run.said();
  run.run(0.5);
  const Vec3 u = run.vector("/low", "displacement");
  EXPECT_NEAR(u.x(), 0.05, 1e-4);  // glides on
  EXPECT_LT(std::abs(u.z()), 1e-8);
  EXPECT_NEAR(run.vector("/table", "reaction").z(), weight, 0.02 * weight);
  EXPECT_EQ(run.vector("/table", "reaction").x(), 0);
}

TEST(Starts, AThreadIsThrownAndSpun) {
  TextRun run(
      "<SutureThread name=\"s\" needle_length=\"0\" thread=\"4-0 nylon\" thread_length=\"100 mm\" "
      "tip_direction=\"-1 0 0\" velocity=\"0 0 2 m/s\" spin=\"0 0 5 rad/s\"/>");
  ASSERT_TRUE(run) << run.said();
  const Real mass = 27.42021338e-7;  // d01, kg
  EXPECT_NEAR(run.vector("/s", "momentum").z(), 2 * mass, 1e-6 * mass);
  // Half m v^2 and half (m L^2 / 12) w^2.
  EXPECT_NEAR(run.number("/s", "kinetic_energy"), mass * (2 + 0.01 / 24 * 25), 1e-5 * 2 * mass);
}

}  // namespace
}  // namespace sutura::testing
