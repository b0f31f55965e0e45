// A thread that begins sewn (SuturePath sewn="true") behaves as one that its needle has sewn.
#include <map>
#include <numbers>

#include "scenes/text_run.h"
#include "sutura/laws/turning_force.h"

namespace sutura::testing {
namespace {

/// A wire through a soft slab, held 15 mm above its tip: driven through from above until 1 s, or
/// there from the start; from 1.2 s to 1.6 s moved aside by 0.3 mm.
std::string wire(bool is_sewn) {
  const std::string height = is_sewn ? "-9" : "1";
  return std::string(
             "<BlockMesh box=\"-5 -5 -5  5 5 0 mm\" cells=\"10 10 5\"/>"
             "<Tissue young=\"50 kPa\" poisson=\"0.4\" damping_stiffness=\"5 ms\"/>"
             "<Attach box=\"-5 -5 -5  -5 5 0 mm\"/> <Attach name=\"right\" "
             "box=\"5 -5 -5  5 5 0 mm\"/>"
             "<SutureThread name=\"wire\" needle_length=\"30 mm\" needle_angle=\"0\" "
             "needle_diameter=\"0.5 mm\" tip=\"0.1 0.1 ") +
         height +
         " mm\" tip_direction=\"0 0 -1\" plane_normal=\"0 1 0\" thread_length=\"30 mm\"/>"
         "<Track name=\"way\" times=\"0 1 1.2 1.6 s\" positions=\"" +
         (is_sewn ? "0 0 0  0 0 0  0 0 0  0.3 0 0" : "0 0 0  0 0 -10  0 0 -10  0.3 0 -10") +
         " mm\"/> <Grasper at=\"15 mm\" track=\"way\"/>"
         "<SuturePath spacing=\"1 mm\"" +
         (is_sewn ? " sewn=\"true\"" : "") +
         "/><PathFriction coefficient=\"0.2\" pressure=\"10 kPa\"/> <Puncture threshold=\"0.1 "
         "N\"/>";
}

TEST(Sewn, ResistsAsAThreadThatItsNeedleHasSewn) {
  TextRun sewn(wire(true)), pierced(wire(false));
  ASSERT_TRUE(sewn) << sewn.said();
  ASSERT_TRUE(pierced) << pierced.said();
  // Laid, not pressed: nothing is strained at the start, but by nanometres of a mouth's place.
  EXPECT_TRUE(sewn.simulation().step().solved);
  EXPECT_LT(sewn.number("/suture_path", "lateral_force"), 1e-6);
  EXPECT_LT(sewn.number("/suture_path", "lateral_gap"), 1e-8);
  for (TextRun* run : {&sewn, &pierced}) run->run(2);
  EXPECT_EQ(sewn.number("/puncture", "punctures"), 0);
  EXPECT_EQ(pierced.number("/puncture", "punctures"), 2);
  // The needle dents the tissue by tenths of a millimetre where it goes in and out, so that its
  // channel is as much longer or shorter.
  const Real length = sewn.number("/suture_path", "inserted_length");
  EXPECT_NEAR(length, 5e-3, 0.02 * 5e-3);
  EXPECT_NEAR(pierced.number("/suture_path", "inserted_length"), length, 0.05 * length);
  const Real limit = sewn.number("/path_friction", "limit");
  EXPECT_NEAR(pierced.number("/path_friction", "limit"), limit, 0.05 * limit);
  const Real pull = sewn.vector("/grasper", "force").x();
  EXPECT_GT(pull, 0.01);
  EXPECT_NEAR(pierced.vector("/grasper", "force").x(), pull, 0.05 * pull);
}

/// A thread that leaves one lip of a wound and enters the other.
TEST(Sewn, GoesThroughBothLipsOfAWound) {
  const auto run = [](const std::string& thread) {
    return TextRun(
        "<node name=\"skin\"> <TetMesh file=\"../meshes/strip.msh\" unit=\"mm\"/> <Tissue "
        "young=\"50 kPa\"/> <Attach box=\"-10 -9 -5  10 9 -5 mm\"/> </node>"
        "<SutureThread name=\"wire\" needle_length=\"5 mm\" needle_angle=\"0\" " +
        thread + " plane_normal=\"0 1 0\" thread_length=\"30 mm\"/> <SuturePath sewn=\"true\"/>");
  };
  TextRun across = run("tip=\"15 0.3 -2.2 mm\" tip_direction=\"1 0 0\"");
  ASSERT_TRUE(across) << across.said();
  across.simulation().step();
  // 20 mm in two lips that are 0.2 mm apart.
  EXPECT_NEAR(across.number("/suture_path", "inserted_length"), 19.8e-3, 1e-8);
  EXPECT_EQ(std::get<std::string>(across.output("/suture_path", "state")), "outside");
  TextRun beside = run("tip=\"15 0.3 2 mm\" tip_direction=\"1 0 0\"");
  EXPECT_FALSE(beside);
  EXPECT_NE(beside.said().find("no part of it goes through the tissue"), std::string::npos);
}

/// A bent wire of radius R through a slab, drawn aside. What its path says in the last pass of how
/// the force across the wire turns: the stiffness along it, times R, over that force, by sample.
std::vector<Real> stiffness_over_force(const std::string& aside) {
  constexpr Real R = 30e-3 / (std::numbers::pi / 3);
  TextRun run(
      "<BlockMesh box='-5 -5 -5  5 5 0 mm' cells='10 10 5'/>"
      "<Tissue young='50 kPa' poisson='0.4' damping_stiffness='5 ms'/>"
      "<Attach box='-5 -5 -5  -5 5 0 mm'/> <Attach name='right' box='5 -5 -5  5 5 0 mm'/>"
      "<SutureThread name='wire' needle_length='30 mm' needle_angle='60 deg' "
      "needle_diameter='0.5 mm' tip='0.1 0.1 -13 mm' tip_direction='0 0 -1' "
      "plane_normal='0 1 0' thread_length='30 mm'/>"
      "<Track name='way' times='0 0.2 s' positions='0 0 0  " +
      aside +
      " 0 0 mm'/> <Grasper at='8 mm' track='way'/>"
      "<SuturePath name='path' spacing='1 mm' sewn='true'/>");
  EXPECT_TRUE(run) << run.said();
  if (!run) return {};
  run.run(0.2);
  const ConstraintProblem& problem = run.simulation().problem();
  std::map<std::uint64_t, Real> across;  // N, by sample
  std::vector<Real> out;
  for (const ConstraintBlock& b : problem.blocks) {
    const std::uint64_t name = local_of(b.key);
    if (std::string_view(b.law->name) != TurningForce::name) {
      across[name] = problem.lambda.segment<2>(b.first_row).norm();
      continue;
    }
    const std::uint64_t sample = (name & ((std::uint64_t{1} << 38) - 1)) >> 8;
    const auto& of = *static_cast<const TurningForce::Params*>(problem.block_params(b));
    out.push_back(R * of.stiffness / across.at(sample));
    EXPECT_NEAR(of.coupling, across.at(sample) / 1e-3, 0.01 * of.coupling);  // the arm: 4 radii
  }
  return out;
}

// As it slides by a length s along itself, a force f across it turns by s / R, so that it resists
// by f s / R where it points away from the centre, and drives where it points to it. The slab holds
// back what is drawn aside: on one side all of it resists, on the other all of it drives.
TEST(Sewn, AForceAcrossABentWireResistsItsSliding) {
  const std::vector<Real> one = stiffness_over_force("-0.3"), other = stiffness_over_force("0.3");
  ASSERT_GE(one.size(), 4u);  // 5 mm, a sample each
  ASSERT_GE(other.size(), 4u);
  const Real sign = one.front() > 0 ? 1 : -1;
  // Of beams of half a millimetre, and forces that are not quite in the plane of the wire.
  for (const Real ratio : one) EXPECT_NEAR(ratio, sign, 0.02);
  for (const Real ratio : other) EXPECT_NEAR(ratio, -sign, 0.02);
}

}  // namespace
}  // namespace sutura::testing
