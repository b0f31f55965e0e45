// H, W and warm starts as the builder makes them, against dense algebra written out here.
#include <gtest/gtest.h>

#include <random>

#include "small_world.h"
#include "sutura/laws/bilateral.h"
#include "sutura/laws/coulomb.h"
#include "sutura/laws/unilateral.h"

using namespace sutura;
using namespace sutura::test;

namespace {

MatX random_matrix(Index rows, Index cols, std::mt19937_64& random) {
  std::normal_distribution<Real> normal;
  MatX m(rows, cols);
  for (Real& x : m.reshaped()) x = normal(random);
  return m;
}

MatX dense(const BodyRows& rows, Index all, Index dofs) {
  MatX H = MatX::Zero(all, dofs);
  for (std::size_t i = 0; i < rows.row.size(); ++i)
    for (Index e = rows.start[i]; e < rows.start[i + 1]; ++e)
      for (int k = 0; k < rows.width; ++k)
        H(rows.row[i], rows.node[static_cast<std::size_t>(e)] * rows.width + k) +=
            rows.value[static_cast<std::size_t>(e * rows.width + k)];
  return H;
}

struct Fixture : ::testing::Test {
  std::mt19937_64 random{11};
  PointMasses a{6, 0.01}, b{4, 0.002};
  Fixture() {
    for (int i = 0; i + 1 < 6; ++i) a.add_spring(i, i + 1, Vec3(1, 2, 2) / 3, 50.0 * (i + 1));
    for (int i = 0; i < 4; ++i) b.add_spring(i, i % 3, 20);
  }
};

TEST_F(Fixture, RowsAndComplianceEqualTheDenseProducts) {
  SmallWorld world({&a, &b}, {});
  // Three blocks; the second couples body a twice, once at a node it already has; the order of
  // couplings is mixed.
  const MatX D1 = random_matrix(1, 3, random), D2 = random_matrix(3, 3, random),
             D3 = random_matrix(3, 3, random), D4 = random_matrix(2, 3, random),
             D5 = random_matrix(3, 3, random), D6 = random_matrix(2, 3, random);
  MatX Ha = MatX::Zero(6, 18), Hb = MatX::Zero(6, 12);
  Ha.block(0, 0, 1, 3) = D1;
  Ha.block(1, 6, 3, 3) = D2 + D3;
  Ha.block(1, 15, 3, 3) = D5;
  Hb.block(1, 3, 3, 3) = -D2;
  Hb.block(4, 9, 2, 3) = D4;
  Ha.block(4, 12, 2, 3) = D6;
  world.step([&](ConstraintBuilder& builder) {
    const BlockId one = builder.add<Unilateral>({1}, {}, BlockVector<1>(0.0));
    const BlockId two = builder.add<Coulomb>({2}, {.mu = 0.3}, Vec3(0, 0, 0));
    const BlockId three = builder.add<Bilateral<2>>({3}, {}, Vec2(0, 0));
    world.couple(builder, two, a, 2, D2);
    world.couple(builder, three, b, 3, D4);
    world.couple(builder, two, b, 1, -D2);
    world.couple(builder, one, a, 0, D1);
    world.couple(builder, two, a, 5, D5);
    world.couple(builder, three, a, 4, D6);
    world.couple(builder, two, a, 2, D3);
  });
  EXPECT_EQ(world.problem().rows(), 6);
  EXPECT_LT((dense(world.problem().bodies[0], 6, 18) - Ha).norm(), 1e-15);
  EXPECT_LT((dense(world.problem().bodies[1], 6, 12) - Hb).norm(), 1e-15);
  // Equal nodes of one block are merged: 1 + 3 * 2 + 2 entries on body a.
  EXPECT_EQ(world.problem().bodies[0].node.size(), 9u);

  const auto inverse = [](const Body& body) {
    MatX I = MatX::Identity(body.dofs(), body.dofs());
    body.solve(I);
    return I;
  };
  const MatX W = 1e-4 * (Ha * inverse(a) * Ha.transpose() + Hb * inverse(b) * Hb.transpose());
  const MatX made = world.compliance();
  EXPECT_LT((made - W).norm(), 1e-13 * W.norm());
  EXPECT_EQ(made, MatX(made.transpose()));  // to the last bit

  VecX lambda = random_matrix(6, 1, random), f = VecX::Zero(18);
  world.problem().bodies[0].add_transposed(lambda, f);
  EXPECT_LT((f - Ha.transpose() * lambda).norm(), 1e-14 * f.norm());

  // The first coupling says where and on whom the force is drawn.
  ConstraintProblem problem = world.problem();
  problem.lambda = lambda;
  const Vec3 force = problem.block_force(problem.blocks[1]);
  EXPECT_LT((force - D2.transpose() * lambda.segment<3>(1)).norm(), 1e-14);
}

TEST_F(Fixture, ManyRowsGoThroughSeveralChunks) {
  SmallWorld world({&a, &b}, {.dt = 0.02});
  MatX H = MatX::Zero(60, 18);
  std::vector<MatX> directions;
  for (int i = 0; i < 20; ++i) {
    directions.push_back(random_matrix(3, 3, random));
    H.block(3 * i, 3 * (i % 6), 3, 3) = directions.back();
  }
  world.step([&](ConstraintBuilder& builder) {
    for (int i = 0; i < 20; ++i) {
      const BlockId id =
          builder.add<Bilateral<3>>({std::uint64_t(i)}, {.compliance = 1}, Vec3::Zero());
      world.couple(builder, id, a, i % 6, directions[static_cast<std::size_t>(i)]);
    }
  });
  MatX inverse = MatX::Identity(18, 18);
  a.solve(inverse);
  const MatX W = 4e-4 * H * inverse * H.transpose();
  EXPECT_LT((world.compliance() - W).norm(), 1e-13 * W.norm());
}

TEST_F(Fixture, WarmStartFollowsTheKeyNotThePlace) {
  ConstraintProblem problem;
  ConstraintBuilder builder(problem, {&a});
  const auto add = [&](std::vector<std::uint64_t> keys) {
    for (const std::uint64_t key : keys)
      builder.add<Bilateral<1>>({key}, {.compliance = 1}, BlockVector<1>(1e-3 * Real(key)));
  };
  builder.begin();
  add({5, 1, 9});
  builder.finish();
  problem.lambda << 0.5, 0.1, 0.9;
  builder.accept();
  builder.begin();
  add({9, 7, 5});
  // Same key as block 1, another law: not its heir.
  builder.add<Unilateral>({1}, {}, BlockVector<1>(0.0));
  builder.finish();
  EXPECT_EQ(problem.lambda, (VecX(4) << 0.9, 0, 0.5, 0).finished());
}

/// One row that rests in mode 0; a block that ends a step in mode 1 begins the next in 3.
struct Tiring : Bilateral<1> {
  static constexpr const char* name = "tiring";
  static Mode next_mode(const Params&, const BlockVector<1>& delta, Mode mode,
                        const BlockVector<1>&) {
    return mode == 1 && delta[0] > 0 ? Mode(3) : mode;
  }
};

// A block keeps force and mode, between passes and between steps.
TEST_F(Fixture, ForceAndModeAreKept) {
  using Warm = ConstraintBuilder::Warm;
  const std::vector<const Body*> bodies{&a};
  ConstraintProblem problem;
  ConstraintBuilder builder(problem, bodies);
  const auto build = [&](Warm warm) {
    builder.begin(warm);
    for (const std::uint64_t key : {3, 8})
      builder.add<Coulomb>({key}, {.mu = 0.1}, Vec3(1e-3, 2e-3, Real(key)), Mode(4));
    builder.finish();
  };
  build(Warm::step_before);
  EXPECT_EQ(builder.known_mode({8}, Mode(5)), 5);
  EXPECT_TRUE(problem.lambda.isZero(0));
  problem.lambda << 1, 2, 3, 4, 5, 6;
  problem.blocks[0].mode = 1;
  problem.blocks[1].mode = 2;
  const VecX first = problem.lambda;

  build(Warm::pass_before);
  EXPECT_EQ(problem.lambda, first);
  EXPECT_EQ(problem.blocks[0].mode, 1);
  EXPECT_EQ(problem.blocks[1].mode, 2);
  EXPECT_EQ(builder.known_mode({8}, Mode(5)), 2);
  // What a source measures is the gap, and so far all there is of delta and d_free.
  EXPECT_EQ(problem.gap, (VecX(6) << 1e-3, 2e-3, 3, 1e-3, 2e-3, 8).finished());
  EXPECT_EQ(problem.d_free, problem.gap);
  EXPECT_EQ(problem.delta, problem.gap);

  // A step that is begun anew: nothing of its passes was accepted.
  build(Warm::step_before);
  EXPECT_TRUE(problem.lambda.isZero(0));
  EXPECT_EQ(problem.blocks[1].mode, 4);

  problem.lambda = first;
  problem.blocks[1].mode = 2;
  builder.accept();
  problem.lambda *= 7;  // a later try leaves no trace
  problem.blocks[1].mode = 1;
  build(Warm::step_before);
  EXPECT_EQ(problem.lambda, first);
  EXPECT_EQ(problem.blocks[0].mode, 4);
  EXPECT_EQ(problem.blocks[1].mode, 2);
}

// A law may say in which mode a block begins the next step; within a step it is not asked.
TEST_F(Fixture, TheLawSaysInWhichModeTheNextStepBegins) {
  using Warm = ConstraintBuilder::Warm;
  ConstraintProblem problem;
  ConstraintBuilder builder(problem, {&a});
  const auto build = [&](Warm warm, Real gap) {
    builder.begin(warm);
    builder.add<Tiring>({1}, {}, BlockVector<1>(gap));
    builder.finish();
  };
  for (const Real gap : {1.0, -1.0}) {
    build(Warm::step_before, gap);
    problem.blocks[0].mode = 1;
    build(Warm::pass_before, gap);
    EXPECT_EQ(problem.blocks[0].mode, 1);
    builder.accept();
    build(Warm::step_before, gap);
    EXPECT_EQ(problem.blocks[0].mode, gap > 0 ? 3 : 1);
  }
}

TEST_F(Fixture, NothingIsAllocatedOnceWarm) {
  SmallWorld world({&a, &b}, {});
  const auto build = [&](ConstraintBuilder& builder) {
    for (int i = 0; i < 30; ++i) {
      const BlockId id = builder.add<Coulomb>({std::uint64_t(i)}, {.mu = 0.1}, Vec3(1, 0, 0));
      world.couple(builder, id, a, i % 6, Mat3::Identity());
      world.couple(builder, id, b, i % 4, -Mat3::Identity());
    }
  };
  world.step(build);
  world.step(build);
  const auto* blocks = world.problem().blocks.data();
  const auto* params = world.problem().params.data();
  const Real* lambda = world.problem().lambda.data();
  const Real* value = world.problem().bodies[0].value.data();
  world.step(build);
  EXPECT_EQ(blocks, world.problem().blocks.data());
  EXPECT_EQ(params, world.problem().params.data());
  EXPECT_EQ(lambda, world.problem().lambda.data());
  EXPECT_EQ(value, world.problem().bodies[0].value.data());
}

TEST_F(Fixture, ForcesOfACouplingAreOppositeAndMomentumIsKept) {
  // Two bodies held together at a point: what one gets the other gives (1e-10 of the force),
  // whatever the solver leaves.
  PointMasses one(3, 0.01), two(2, 0.03);
  for (Index i = 0; i < one.v.size(); ++i) one.v[i] = 0.1 * std::sin(Real(i) + 1);
  SmallWorld world({&one, &two}, {.solver_tolerance = 1e-4});
  const Vec3 before = one.momentum() + two.momentum();
  for (int step = 0; step < 20; ++step)
    world.step([&](ConstraintBuilder& builder) {
      const Vec3 gap =
          one.position(1, Configuration::current) - two.position(0, Configuration::current);
      const BlockId id = builder.add<Bilateral<3>>({1}, {}, gap);
      world.couple(builder, id, one, 1, Mat3::Identity());
      world.couple(builder, id, two, 0, -Mat3::Identity());
    });
  EXPECT_LT((one.momentum() + two.momentum() - before).norm(), 1e-13 * before.norm() + 1e-16);
}

}  // namespace
