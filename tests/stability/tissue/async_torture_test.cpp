// The cases of torture_test.cpp with the asynchronous solver beside the direct one. Whatever the
// age of the factor, every step is solved as well as asked, and the motion stays with that of the
// direct solver.
#include <gtest/gtest.h>

#include <iostream>

#include "tissue_meshes.h"
#include "tissue_scene.h"

namespace sutura::tissue {
namespace {

using test::kuhn_block;
using test::TissueScene;

struct Case {
  const char* name;
  std::string components;  ///< `solver` is put before it
  MeshData mesh;
  int steps;
  std::string dt = "10 ms", gravity = "0 0 -9.81";
  void (*disturb)(VecX& x, VecX& v) = nullptr;
};

struct Comparison {
  Real apart = 0;      ///< m, largest distance of a node from where the direct solver has it, ever
  Real travelled = 0;  ///< m, largest distance of a node from its start, ever
  Real imbalance = 0;  ///< worst of all steps
  Index iterations = 0, age = 0;  ///< largest
  bool finite = true, solved = true;
};

constexpr Real tolerance = StepLimits{}.tolerance;

Comparison compare(const Case& c) {
  const std::string file = std::string(SUTURA_BINARY_DIR) + "/async_" + c.name + ".msh";
  test::write_msh(c.mesh, file);
  const std::string mesh = "<TetMesh file='" + file + "' unit='m'/>";
  TissueScene direct(mesh + c.components, c.gravity, c.dt);
  TissueScene async(mesh + "<AsyncPreconditioner tolerance='1e-6' lag='5'/>" + c.components,
                    c.gravity, c.dt);
  EXPECT_TRUE(direct.diagnostics.ok()) << test::all_messages(direct.diagnostics);
  EXPECT_TRUE(async.diagnostics.ok()) << test::all_messages(async.diagnostics);
  VecX x = direct.tissue().positions(), v = VecX::Zero(x.size());
  if (c.disturb) c.disturb(x, v);
  direct.tissue().set_state(x, v);
  async.tissue().set_state(x, v);
  Comparison r;
  for (int i = 0; i < c.steps; ++i) {
    r.finite = direct.step().finite && async.step().finite && r.finite;
    for (TissueScene* scene : {&direct, &async}) {
      const StepReport& step = scene->simulation().report();
      r.solved = r.solved && step.solved;
      r.imbalance = std::max(r.imbalance, step.worst_imbalance().relative);
    }
    const TissueSolveReport& report = async.tissue().solve_report();
    r.iterations = std::max(r.iterations, report.iterations);
    r.age = std::max(r.age, report.factor_age);
    const VecX& there = direct.tissue().positions();
    r.apart = std::max(r.apart, (async.tissue().positions() - there).cwiseAbs().maxCoeff());
    r.travelled = std::max(r.travelled, (there - x).cwiseAbs().maxCoeff());
  }
  std::cout << "  " << c.name << ": apart " << r.apart << " m, travelled " << r.travelled
            << " m, imbalance " << r.imbalance << ", iterations " << r.iterations << ", age "
            << r.age << "\n";
  return r;
}

void expect_agreement(const Case& c, Real errors) {
  const Comparison r = compare(c);
  EXPECT_TRUE(r.finite);
  EXPECT_TRUE(r.solved);
  EXPECT_LE(r.imbalance, tolerance);
  EXPECT_GT(r.age, 0);  // otherwise nothing was asynchronous
  EXPECT_LT(r.apart, errors * tolerance * r.travelled);
}

/// A step errs by its tolerance of the forces at work in it. A held body forgets what went before:
/// apart by the tolerance.
void expect_held(const Case& c) {
  expect_agreement(c, 1);
}
/// A free body forgets nothing: the error of every step stays.
void expect_free(const Case& c) {
  expect_agreement(c, c.steps);
}

MeshData column() {
  return kuhn_block({4, 4, 8}, Vec3(0.02, 0.02, 0.04));
}
const std::string hung = "<Attach box='0 0 40  20 20 40 mm'/>";

TEST(AsyncTorture, NearlyIncompressible) {
  expect_held(
      {"NearlyIncompressible", "<Tissue young='10 kPa' poisson='0.4999'/>" + hung, column(), 150});
}

TEST(AsyncTorture, RegionsOneAMillionTimesStiffer) {
  MeshData mesh = column();
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    Real z = 0;
    for (const Index i : mesh.tets[e]) z += mesh.points[i][2] / 4;
    mesh.region[e] = z > 0.02 ? 1 : 2;
  }
  expect_held({"StiffnessRatio",
               "<Tissue/><Layer name='soft' region='1' young='1 kPa' poisson='0'/>"
               "<Layer name='hard' region='2' young='1 GPa' poisson='0'/>" +
                   hung,
               mesh, 150});
}

TEST(AsyncTorture, Slivers) {
  MeshData mesh = column();
  for (Vec3& p : mesh.points)
    if (p[2] > 0.0199) p[2] -= 0.005 * 0.999;  // one layer of cells, a thousandth of its height
  expect_held({"Slivers", "<Tissue young='5 kPa' poisson='0.3'/><Attach box='0 0 35 20 20 36 mm'/>",
               mesh, 150});
}

TEST(AsyncTorture, OneInvertedElement) {
  expect_free({"Inverted", "<Tissue young='10 kPa' poisson='0.45'/>",
               kuhn_block({4, 4, 4}, Vec3::Constant(0.04)), 100, "10 ms", "0 0 0",
               [](VecX& x, VecX&) {
                 x.segment<3>(3 * (2 * 25 + 2 * 5 + 2)) += Vec3(0.017, 0.013, 0.011);
               }});
}

TEST(AsyncTorture, FlungByHalfATurnInOneStep) {
  expect_free({"Flung", "<Tissue young='10 kPa' poisson='0.45'/>",
               kuhn_block({4, 4, 4}, Vec3::Constant(0.05)), 50, "10 ms", "0 0 0",
               [](VecX& x, VecX& v) {
                 const Vec3 spin = Vec3(0.3, 1, 0.2).normalized() * M_PI / 0.01;
                 for (Index i = 0; i < v.size(); i += 3)
                   v.segment<3>(i) = spin.cross(x.segment<3>(i) - Vec3::Constant(0.025));
               }});
}

TEST(AsyncTorture, StepsOf50Milliseconds) {
  expect_held({"LargeSteps",
               "<Tissue young='30 kPa' poisson='0.4' damping_stiffness='0.1 s'/>"
               "<Attach box='0 0 0 0 20 20 mm'/>",
               kuhn_block({10, 2, 2}, Vec3(0.1, 0.02, 0.02)), 150, "50 ms"});
}

}  // namespace
}  // namespace sutura::tissue
