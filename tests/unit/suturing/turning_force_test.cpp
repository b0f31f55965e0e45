// Forces across a thread turn with it: what SuturePath says of that is the derivative of its rows'
// forces, taken by differences.
#include "sutura/laws/turning_force.h"

#include <gtest/gtest.h>

#include <random>

#include "slab_world.h"

namespace sutura::testing {
namespace {

constexpr Real radius_of_bend = 20e-3, half_angle = 0.3;

/// A rigid arc about the y axis, the abscissa growing upwards; it is where the test puts it.
struct RigidArc : RigidNeedle {
  Vec3 shift = Vec3::Zero(), turn = Vec3::Zero();

  static void describe(Describe<RigidArc>& d) { d.summary("Rigid arc."); }
  Index dofs() const override { return 6; }
  int width() const override { return 6; }
  Quat rotation(Configuration c) const {
    const Real angle = c == Configuration::current ? turn.norm() : 0;
    return angle > 0 ? Quat(Eigen::AngleAxis(angle, turn / angle)) : Quat::Identity();
  }
  Vec3 lever(Real s, Configuration c) const {
    const Real a = s / radius_of_bend - half_angle;
    return rotation(c) * (radius_of_bend * Vec3(-std::cos(a), 0, std::sin(a)));
  }
  Real length() const override { return 2 * half_angle * radius_of_bend; }
  Vec3 point(Real s, Configuration c) const override {
    return lever(s, c) + (c == Configuration::current ? shift : Vec3::Zero());
  }
  Vec3 tangent(Real s, Configuration c) const override {
    const Real a = s / radius_of_bend - half_angle;
    return rotation(c) * Vec3(std::sin(a), 0, std::cos(a));
  }
  void jacobian(Real s, PointJacobian& J) const override {
    const Vec3 r = lever(s, Configuration::current);
    J.nodes = 1;
    J.width = 6;
    J.node[0] = 0;
    J.coefficients.resize(3, 6);
    J.coefficients << 1, 0, 0, 0, r.z(), -r.y(), 0, 1, 0, -r.z(), 0, r.x(), 0, 0, 1, r.y(), -r.x(),
        0;
  }
  Real closest_abscissa(const Vec3& p, Real, Real low, Real high, Configuration c) const override {
    const Vec3 to =
        rotation(c).conjugate() * (p - (c == Configuration::current ? shift : Vec3::Zero()));
    return std::clamp(radius_of_bend * (std::atan2(to.z(), -to.x()) + half_angle), low, high);
  }
};

class TurningForces : public ::testing::Test {
 protected:
  void SetUp() override {
    enrol_slab_world(registry);
    registry.component<RigidArc>("RigidArc");
    Diagnostics diagnostics;
    auto scene = load_scene_text(
        "<sutura version='1' gravity='0 0 0' dt='10 ms'><RigidArc name='arc'/><SpringSlab "
        "name='slab' thickness='4 mm'/><SuturePath name='path' spacing='1 mm' sewn='true'/>"
        "</sutura>",
        "arc", ".", registry, diagnostics);
    for (const Diagnostic& d : diagnostics.all()) ADD_FAILURE() << d.text();
    sim = Simulation::compile(std::move(scene), ".", diagnostics);
    for (const Diagnostic& d : diagnostics.all()) ADD_FAILURE() << d.text();
    arc = dynamic_cast<RigidArc*>(sim->find("/arc"));
    slab = dynamic_cast<SpringSlab*>(sim->find("/slab"));
    path = dynamic_cast<ConstraintSource*>(sim->find("/path"));
  }
  /// Where the two are moved by u: the rows, with the forces that they had before.
  void build_at(const VecX& u) {
    arc->shift = u.head<3>();
    arc->turn = u.segment<3>(3);
    slab->u_ = u.tail<3>();
    builder->begin(ConstraintBuilder::Warm::pass_before);
    path->detect(context);
    path->build(context, *builder);
    builder->finish();
  }
  /// H^T lambda: force and moment on the arc, force on the slab.
  VecX forces(const VecX& lambda) const {
    VecX of_arc = VecX::Zero(6), of_slab = VecX::Zero(3), all(9);
    problem.bodies[0].add_transposed(lambda, of_arc);
    problem.bodies[1].add_transposed(lambda, of_slab);
    all << of_arc, of_slab;
    return all;
  }

  Registry registry;
  std::unique_ptr<Simulation> sim;
  RigidArc* arc = nullptr;
  SpringSlab* slab = nullptr;
  ConstraintSource* path = nullptr;
  ConstraintProblem problem;
  std::unique_ptr<ConstraintBuilder> builder;
  StepContext context{.dt = 0.01, .pass = 1, .gravity = Vec3::Zero()};
};

TEST_F(TurningForces, AreTheDerivativeOfTheForcesOfTheRows) {
  problem.bodies.resize(2);
  builder = std::make_unique<ConstraintBuilder>(problem, std::vector<const Body*>{arc, slab});
  build_at(VecX::Zero(9));
  ASSERT_GE(problem.blocks.size(), 4u);
  std::mt19937_64 random(1);
  std::normal_distribution<Real> normal(0, 0.1);
  for (Real& lambda : problem.lambda) lambda = normal(random);
  build_at(VecX::Zero(9));  // the forces are known now, and with them those that turn

  const ConstraintProblem here = problem;
  Index turning = 0;
  for (const ConstraintBlock& b : here.blocks)
    turning += std::string_view(b.law->name) == TurningForce::name;
  ASSERT_GE(turning, 4);
  for (Index k = 0; k < 9; ++k) {
    const VecX u = VecX::Unit(9, k);
    problem = here;
    VecX delta = VecX::Zero(problem.rows()), answer = delta;
    problem.bodies[0].add_product(1, u.head<6>(), delta);
    problem.bodies[1].add_product(1, u.tail<3>(), delta);
    for (const ConstraintBlock& b : problem.blocks) {
      if (std::string_view(b.law->name) != TurningForce::name) continue;
      const auto& p = *static_cast<const TurningForce::Params*>(problem.block_params(b));
      const Real a = delta[b.first_row], turn = delta[b.first_row + 1];
      answer.segment<2>(b.first_row) = -Vec2(p.stiffness * a + p.coupling * turn, p.coupling * a);
    }
    const VecX said = forces(answer);
    const Real step = k >= 3 && k < 6 ? 1e-5 : 1e-7;
    VecX change = VecX::Zero(9);
    for (const Real side : {1., -1.}) {
      build_at(side * step * u);
      change += side / (2 * step) * forces(problem.lambda);
    }
    const Real rounding = 1e-9 * here.lambda.norm();  // 1e-16 of the forces, over the step
    // The moment about the centre of the arc has the turn of the lever in it as well, which is the
    // body's own. The arm along the thread is 1 mm long: (1 mm / 2 R)^2 / 6 is 1e-4.
    for (const Index i : {0, 1, 2, 6, 7, 8})
      EXPECT_NEAR(said[i], change[i], 1e-3 * change.norm() + rounding)
          << "force " << i << " for motion " << k;
    build_at(VecX::Zero(9));
  }
}

}  // namespace
}  // namespace sutura::testing
