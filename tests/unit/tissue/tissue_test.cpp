// The components TetMesh, Tissue, Layer and Attach, in small scenes.
#include "tissue.h"

#include <gtest/gtest.h>

#include <random>

#include "attach.h"
#include "layer.h"
#include "solver_components.h"
#include "sutura/plugin.h"
#include "sutura/simulation.h"
#include "tissue_load.h"
#include "tissue_scene.h"

namespace sutura::tissue {
namespace {

using test::all_messages;
using test::TissueScene;

const std::string mesh =
    "<TetMesh file='tests/unit/tissue/meshes/msh22_ascii.msh' unit='cm'/>";  // 2 x 1 x 2 cm
const std::string top = "<Attach box='0 0 2  2 1 2' name='top'/>";

TEST(Tissue, FallsFreelyAsImplicitEulerDoes) {
  TissueScene s(mesh + "<Tissue young='30 kPa'/>");
  const Vec3 start = s.tissue().position({0, {1, 0, 0, 0}}, Configuration::current);
  const int n = 50;
  for (int i = 0; i < n; ++i) s.step();
  const Vec3 end = s.tissue().position({0, {1, 0, 0, 0}}, Configuration::current);
  const Real h = 0.01, g = 9.81;
  EXPECT_NEAR(end.z() - start.z(), -g * h * h * n * (n + 1) / 2, 1e-12);  // A7d
  EXPECT_NEAR(end.x(), start.x(), 1e-12);
  EXPECT_NEAR(s.tissue().mass(), 4e-6 * 1000, 1e-15);  // 4 cm^3
  EXPECT_NEAR(s.tissue().momentum().z(), -0.004 * g * h * n, 1e-14);
  EXPECT_NEAR(s.tissue().energy(), 0.5 * 0.004 * std::pow(g * h * n, 2), 1e-12);
}

TEST(Tissue, AttachmentCarriesTheWeightAndMomentumBalancesInEveryStep) {
  TissueScene s(mesh +
                "<Tissue young='5 kPa' poisson='0.4' damping_stiffness='5 ms'/><Attach box='0 0 2  "
                "2 1 2 cm'/>");
  const Real h = 0.01;
  Vec3 before = s.tissue().momentum();
  Real left = 0;  // N
  const Vec3 weight(0, 0, -0.004 * 9.81);
  for (int i = 0; i < 200; ++i) {
    const StepReport& report = s.step();
    EXPECT_TRUE(report.solved);
    const Vec3 reaction = std::get<Vec3>(s.output("/tissue", "reaction"));
    const Vec3 now = s.tissue().momentum();
    // Up to what the step says that its free nodes lack, and the rounding of sums of forces that
    // are far larger than the weight.
    left = report.bodies[0].imbalance.force * static_cast<Real>(s.tissue().model().mass.size());
    EXPECT_LT(((now - before) / h - weight - reaction).norm(), left + 1e-11);
    before = now;
  }
  // Settled: 2 s are more than a hundred times the period damped by implicit Euler.
  EXPECT_LT((std::get<Vec3>(s.output("/tissue", "reaction")) + weight).norm(), left + 1e-9);
  EXPECT_LT(left, 1e-3 * weight.norm());
  EXPECT_LT(std::get<Real>(s.output("/tissue", "lowest")), -1e-5);
  EXPECT_EQ(std::get<Real>(s.output("/tissue", "inverted")), 0);
  EXPECT_EQ(std::get<Vec3>(s.output("/tissue", "reaction")),
            std::get<Vec3>(s.output("/attach", "reaction")));
}

TEST(Tissue, HeldNodesDoNotMoveAtAll) {
  TissueScene s(mesh + "<Tissue young='1 kPa'/><Attach nodes='0 3 5'/>");
  std::vector<Vec3> rest = s.tissue().mesh->data().points;
  for (int i = 0; i < 20; ++i) s.step();
  const BodyGeometry g = s.tissue().geometry();
  for (const Index i : {0, 3, 5}) EXPECT_EQ(g.points[i], rest[i]);
  EXPECT_NE(g.points[1], rest[1]);
}

TEST(Tissue, LayersHaveTheirOwnMaterial) {
  TissueScene s(mesh +
                "<Tissue density='1000'/><Layer name='dermis' region='dermis' young='100 kPa' "
                "density='1200'/>" +
                "<Layer name='seven' region='7' young='2 kPa' density='900'/>");
  EXPECT_NEAR(s.tissue().mass(), 2e-6 * (1200 + 900), 1e-15);
  EmbeddedPoint p = *s.tissue().locate(Vec3(0.01, 0.005, 0.015), Configuration::rest);
  EXPECT_EQ(s.tissue().region(p), 12);
}

// Uniform stretch of a two-layer column by its own ends: with free sides each layer stretches by F
// / (E A).
TEST(Tissue, StressFieldTellsTheLayersApart) {
  TissueScene s(
      mesh +
      "<Tissue poisson='0' density='1000'/><Layer name='dermis' region='dermis' young='50 kPa' "
      "poisson='0'/>" +
      "<Layer name='fat' region='fat' young='5 kPa' poisson='0'/><Attach box='0 0 2  2 1 2 cm'/>");
  for (int i = 0; i < 400; ++i) s.step();
  // Hanging from the top: 1 cm of stiff layer, then 1 cm of soft one. With nu = 0 nothing moves
  // sideways, and the elongation is rho g L^2 (1/2 + 1) / E_stiff + rho g L^2 / 2 E_soft; linear
  // tets of one layer each take the mean strain exactly when the load is linear, so only lumping of
  // the weight (h^2) remains: 10 % on this coarse mesh.
  const Real expected = 1000 * 9.81 * 1e-4 * (1.5 / 50e3 + 0.5 / 5e3);
  EXPECT_NEAR(-std::get<Real>(s.output("/tissue", "lowest")) / expected, 1, 0.1);
}

TEST(Tissue, JacobianIsTheDerivativeOfThePosition) {
  TissueScene s(mesh + "<Tissue/>");
  const EmbeddedPoint inner = *s.tissue().locate(Vec3(0.01, 0.005, 0.015), Configuration::rest);
  PointJacobian J;
  s.tissue().jacobian(inner, J);
  EXPECT_EQ(J.nodes, 4);
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < J.nodes; ++k)
    sum += J.coefficients.block<3, 3>(0, 3 * k) * s.tissue().mesh->data().points[J.node[k]];
  EXPECT_LT((sum - Vec3(0.01, 0.005, 0.015)).norm(), 1e-16);
  const auto surface =
      s.tissue().closest_surface(Vec3(0.011, 0.004, 0.03), 0.05, Configuration::rest);
  s.tissue().jacobian(surface->at, J);
  EXPECT_LE(J.nodes, 3);
  EXPECT_NEAR(surface->distance, 0.01, 1e-15);
}

TEST(Tissue, ForceThroughCorrectIsTheComplianceTimesForce) {
  TissueScene s(mesh + "<Tissue young='5 kPa'/><Attach box='0 0 2  2 1 2 cm'/>", "0 0 0");
  s.step();
  StepContext c{.dt = 0.01, .gravity = Vec3::Zero()};
  s.tissue().begin_step(c);
  VecX force = VecX::Zero(s.tissue().dofs());
  const EmbeddedPoint p = *s.tissue().locate(Vec3(0.01, 0.005, 0.001), Configuration::current);
  PointJacobian J;
  s.tissue().jacobian(p, J);
  for (int k = 0; k < 4; ++k)
    force.segment<3>(3 * J.node[k]) += J.coefficients.block<3, 3>(0, 3 * k) * Vec3(0.01, 0, 0.02);
  s.tissue().linearise(c, VecX::Zero(force.size()));
  MatX column = force;
  s.tissue().solve(column);
  const Vec3 before = s.tissue().position(p, Configuration::current);
  EXPECT_LT(s.tissue().change().norm(), 1e-12);  // at rest nothing is missing
  s.tissue().push(c, force);
  s.tissue().correct(c);
  Vec3 expected = before;
  for (int k = 0; k < 4; ++k)
    expected += c.dt * c.dt * p.weights[k] * column.block<3, 1>(3 * J.node[k], 0);
  EXPECT_LT((s.tissue().position(p, Configuration::current) - expected).norm(), 1e-15);
  EXPECT_GT((expected - before).norm(), 1e-7);
}

struct Fault {
  const char* scene;
  const char* words;
  int exit_code;
};
class TissueFaults : public ::testing::TestWithParam<Fault> {};

TEST_P(TissueFaults, AreSaidInASentence) {
  TissueScene s(GetParam().scene);
  EXPECT_EQ(s.diagnostics.exit_code(), GetParam().exit_code);
  EXPECT_NE(all_messages(s.diagnostics).find(GetParam().words), std::string::npos)
      << all_messages(s.diagnostics);
}

#define MESH "<TetMesh file='tests/unit/tissue/meshes/msh22_ascii.msh' unit='cm'/>"
INSTANTIATE_TEST_SUITE_P(
    All, TissueFaults,
    ::testing::Values(
        Fault{"<TetMesh file='nowhere.msh'/><Tissue/><Attach nodes='0'/><Layer region='1'/>",
              "no such file", 3},
        Fault{"<TetMesh file='tests/scenes/malformed_meshes/msh_nan.msh'/><Tissue/>",
              "msh_nan.msh:8: error", 3},
        Fault{"<TetMesh file='tests/scenes/malformed_meshes/msh_flat_tet.msh'/><Tissue/>",
              "has no volume", 3},
        Fault{"<TetMesh unit='cm'/>", "file", 2}, Fault{"<Tissue/>", "TetMesh", 2},
        Fault{MESH "<Tissue poisson='0.5'/>", "poisson", 2},
        Fault{MESH "<Tissue young='-1 Pa'/>", "young", 2},
        Fault{MESH "<Tissue density='0'/>", "density", 2},
        Fault{MESH "<Tissue/><Layer region='bone'/>", "it has 7 (fat), 12 (dermis)", 2},
        Fault{MESH "<Tissue/><Layer name='a' region='fat'/><Layer name='b' region='7'/>",
              "a second layer for region '7'", 2},
        Fault{MESH "<Tissue/><Attach/>", "one of 'box', 'region' and 'nodes' is needed", 2},
        Fault{MESH "<Tissue/><Attach box='5 5 5 6 6 6 cm'/>", "no node of the tissue lies in 'box'",
              2},
        Fault{MESH "<Tissue/><Attach box='5 5 5 6 6 cm'/>", "5 numbers, expected 6", 2},
        Fault{MESH "<Tissue/><Attach nodes='0 100000'/>", "names node 100000, expected", 2},
        Fault{MESH "<Tissue/><Attach nodes='0.5'/>", "names node 0.5, expected whole numbers", 2}));

TEST(TetMesh, GuessesThatMillimetresWereMeant) {
  TissueScene small(
      "<TetMesh file='tests/unit/tissue/meshes/msh22_ascii.msh' unit='m'/>"
      "<Tissue element='t4'/><Attach nodes='0 1 2'/>");
  EXPECT_EQ(all_messages(small.diagnostics), "");
  TissueScene pad("<TetMesh file='scenes/meshes/pad.msh'/><Tissue/>");
  EXPECT_NE(all_messages(pad.diagnostics).find("set unit=\"mm\""), std::string::npos);
  EXPECT_TRUE(pad.diagnostics.ok());
}

TEST(Tissue, DoubtsWhatIsSeldomMeant) {
  const auto said = [](const std::string& tissue, const std::string& words) {
    TissueScene s(MESH + tissue);
    EXPECT_TRUE(s.diagnostics.ok());
    return all_messages(s.diagnostics).find(words) != std::string::npos;
  };
  const std::string held = "<Attach nodes='0 1 2'/>";
  EXPECT_TRUE(said("<Tissue young='20 Pa'/>" + held, "were kPa meant?"));
  EXPECT_FALSE(said("<Tissue young='2 kPa'/>" + held, "were kPa meant?"));
  EXPECT_TRUE(said("<Tissue/><Layer region='fat' young='5 Pa'/>" + held, "[/layer] young is 5 Pa"));
  EXPECT_TRUE(said("<Tissue density='1'/>" + held, "density is 1 kg/m^3"));
  EXPECT_TRUE(said("<Tissue/>", "nothing holds this tissue"));
  EXPECT_FALSE(said("<Tissue/>" + held, "nothing holds this tissue"));
  // Said of linear tets near incompressibility, unless the scene chose them.
  EXPECT_TRUE(said("<Tissue poisson='0.45'/>" + held, "element=\"smoothed\" is accurate"));
  EXPECT_TRUE(said("<Tissue poisson='0.3'/><Layer region='fat' poisson='0.45'/>" + held,
                   "[/layer] poisson is 0.45"));
  for (const char* element : {"t4", "smoothed"})
    EXPECT_FALSE(said("<Tissue poisson='0.45' element='" + std::string(element) + "'/>" + held,
                      "too stiffly"));
  EXPECT_FALSE(said("<Tissue poisson='0.3'/>" + held, "too stiffly"));
  TissueScene large("<TetMesh file='scenes/meshes/pad.msh' unit='m'/><Tissue/>" + held);
  EXPECT_NE(all_messages(large.diagnostics).find("the mesh is 50 m long"), std::string::npos);
}

// Pressure on a closed surface has a potential, p V, so its stiffness is symmetric: that of the
// matrix is all of it. Forces are of second order in the positions, and central differences exact.
TEST(TissueLoad, HasTheStiffnessOfItsPressure) {
  TissueScene s(mesh +
                    "<Tissue young='30 kPa'/><TissueLoad box='-1 -1 -1 3 3 3 cm' "
                    "pressure='1 kPa'/>",
                "0 0 0", "10 ms", [](Registry& r) { r.component<TissueLoad>("TissueLoad"); });
  ASSERT_TRUE(s.diagnostics.ok()) << all_messages(s.diagnostics);
  s.step();
  TissueModel& model = s.tissue().model();
  ASSERT_EQ(model.followers.size(), 1u);
  FollowerLoad& load = *model.followers[0];
  const VecX x = s.tissue().positions();
  const Real step = 1e-4;  // m
  std::mt19937 random(1);
  std::uniform_real_distribution<Real> any(-1, 1);
  for (int k = 0; k < 5; ++k) {
    const VecX way = VecX::NullaryExpr(x.size(), [&] { return any(random); });
    VecX change = VecX::Zero(x.size());
    load.follow(x - step * way, change);
    change.setZero();
    load.follow(x + step * way, change);
    NodeMatrix K(model.dofs() / 3, model.elastic->pairs());
    K.set_zero();
    load.add_stiffness(x, 1, K);
    VecX by_stiffness(x.size());
    K.multiply(way, by_stiffness);
    EXPECT_LT((change / (2 * step) + by_stiffness).norm(), 1e-9 * by_stiffness.norm());
    EXPECT_GT(by_stiffness.norm(), 0);
  }
}

// The pad of the demo.
TEST(TetMesh, ThePadHasTwoLayersAndEnoughNodes) {
  TissueScene s(
      "<TetMesh file='scenes/meshes/pad.msh' unit='mm'/><Tissue element='t4'/>"
      "<Attach box='-25 -15 -10  25 15 -10 mm'/>");
  ASSERT_TRUE(s.diagnostics.ok());
  EXPECT_EQ(all_messages(s.diagnostics), "");
  const TetMesh& pad = *s.tissue().mesh;
  EXPECT_GE(pad.data().points.size(), 2000u);
  EXPECT_LT((pad.report().low - Vec3(-0.025, -0.015, -0.01)).norm(), 1e-12);
  EXPECT_LT((pad.report().high - Vec3(0.025, 0.015, 0)).norm(), 1e-12);
  EXPECT_EQ(pad.report().parts, 1);
  EXPECT_EQ(pad.report().slivers, 0);
  EXPECT_EQ(s.tissue().region(*s.tissue().locate(Vec3(0, 0, -0.0029), Configuration::rest)), 1);
  EXPECT_EQ(s.tissue().region(*s.tissue().locate(Vec3(0, 0, -0.0031), Configuration::rest)), 2);
}

}  // namespace
}  // namespace sutura::tissue
