// Where solvers of thresholds fail: random systems of tips, paths, contacts and holds, all coupled.
// What the solver ends in is compared with the reference solver, which shares the laws but neither
// sweeps nor order.
#include <gtest/gtest.h>

#include "../plugins/suturing/cutting_law.h"
#include "../plugins/suturing/puncture_law.h"
#include "solve/gauss_seidel.h"
#include "solve/reference_solver.h"
#include "solve_problems.h"
#include "sutura/laws/coulomb.h"
#include "sutura/laws/unilateral.h"

using namespace sutura;
using namespace sutura::test;

namespace {

struct Scene {
  ConstraintProblem problem;
  std::vector<suturing::PunctureLaw::Params> tips;
};

/// 5 to 40 blocks of all laws; bodies of very different compliance share the rows.
Scene random_scene(std::uint64_t seed, const Mat3& turn = Mat3::Identity(), Real unit = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<Real> normal;
  std::uniform_real_distribution<Real> uniform(0, 1);
  const auto unit_vector = [&] {
    return Vec3(normal(random), normal(random), normal(random)).normalized();
  };
  Scene scene;
  ConstraintProblem& p = scene.problem;
  const BlockUnits units{.force = 0.1, .length = 1e-4 * unit};
  const int blocks = 5 + static_cast<int>(35 * uniform(random));
  std::vector<bool> world_axes;
  for (int i = 0; i < blocks; ++i) {
    const Real kind = uniform(random);
    if (kind < 0.3) {
      suturing::PunctureLaw::Params q;
      q.normal = unit_vector();
      q.axis = (-q.normal + 0.3 * unit_vector()).normalized();
      q.puncture_force = 0.2 + uniform(random);
      q.cutting_force = 0.3 * q.puncture_force * uniform(random);
      q.friction = 0.2 * uniform(random);
      q.normal = turn * q.normal;
      q.axis = turn * q.axis;
      append<suturing::PunctureLaw>(p, q, suturing::PunctureLaw::pressing, units);
      scene.tips.push_back(q);
      world_axes.push_back(true);
    } else if (kind < 0.6) {
      const Real level = 0.05 * uniform(random);
      append<suturing::PathFrictionLaw>(
          p,
          {.static_level = level * 1.3,
           .kinetic = level,
           .viscous = uniform(random) < 0.5 ? 0 : 2 * uniform(random) / unit,
           .stick_slip = 1e-6 * unit},
          suturing::PathFrictionLaw::stick, units);
    } else if (kind < 0.75) {
      append<Bilateral<3>>(p, {}, 0, units);
      world_axes.push_back(true);
    } else if (kind < 0.85) {
      append<suturing::CuttingLaw>(p, {.threshold = 0.3 * uniform(random)}, 0, units);
    } else if (kind < 0.95) {
      append<Unilateral>(p, {}, 0, units);
    } else {
      append<Coulomb>(p, {.mu = 0.3 * uniform(random)}, 0, units);
    }
    world_axes.resize(p.blocks.size(), false);
  }
  const Index n = p.blocks.back().first_row + p.blocks.back().law->dim;
  // Own compliance of 1 to 10 mm/N, and a shared soft part of rank 6: a light thread.
  MatX B(n, n), soft(n, 6);
  for (Real& x : B.reshaped()) x = normal(random) / std::sqrt(Real(n));
  for (Real& x : soft.reshaped()) x = normal(random);
  const Real softness = std::pow(10, -4 + 4 * uniform(random));
  MatX W = 2e-3 * (B * B.transpose() + MatX::Identity(n, n)) + softness * soft * soft.transpose();
  VecX d = soft * VecX::NullaryExpr(6, [&] { return 1e-3 * normal(random); });
  for (Real& x : d) x += 1e-3 * normal(random);
  MatX turns = MatX::Identity(n, n);
  for (std::size_t i = 0; i < p.blocks.size(); ++i)
    if (world_axes[i]) turns.block<3, 3>(p.blocks[i].first_row, p.blocks[i].first_row) = turn;
  finish(p, unit * turns * W * turns.transpose(), unit * turns * d);
  return scene;
}

/// Whether every force lies in the set its law admits.
void expect_admissible(const ConstraintProblem& p) {
  for (const ConstraintBlock& b : p.blocks) {
    const VecX l = p.lambda.segment(b.first_row, b.law->dim);
    if (b.law == &law_operations<suturing::PathFrictionLaw>) {
      const auto& q = *static_cast<const suturing::PathFrictionLaw::Params*>(p.block_params(b));
      const Real level = b.mode == suturing::PathFrictionLaw::stick ? q.static_level : q.kinetic;
      EXPECT_LE(std::abs(l[0]), level + q.viscous * std::abs(p.delta[b.first_row]) + 1e-6);
    } else if (b.law == &law_operations<suturing::CuttingLaw>) {
      EXPECT_GE(l[0], -1e-6);
      EXPECT_LE(
          l[0],
          static_cast<const suturing::CuttingLaw::Params*>(p.block_params(b))->threshold + 1e-6);
    } else if (b.law == &law_operations<Unilateral>) {
      EXPECT_GE(l[0], -1e-6);
    } else if (b.law == &law_operations<suturing::PunctureLaw> &&
               b.mode == suturing::PunctureLaw::pressing) {
      const auto& q = *static_cast<const suturing::PunctureLaw::Params*>(p.block_params(b));
      const Real n = q.normal.dot(l.head<3>());
      EXPECT_GE(n, -1e-6);
      EXPECT_LE(n, q.puncture_force + 1e-6);
      EXPECT_LE((l.head<3>() - n * q.normal).norm(), q.friction * n + 1e-6);
    }
  }
}

TEST(RandomProblems, NoWrongIrreversibleEvent) {
  int events = 0, unsolved = 0, unsolved_reference = 0, wrong = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    ConstraintProblem a = random_scene(seed).problem, b = a, c = a;
    const SolveReport mine = BlockGaussSeidel({.tolerance = 1e-5}).solve(a);
    const SolveReport other = BlockGaussSeidel({.tolerance = 1e-5, .seed = 99}).solve(c);
    const SolveReport exact = ReferenceSolver({.tolerance = 1e-7}).solve(b);
    unsolved += !mine.converged + !other.converged;
    unsolved_reference += !exact.converged;
    events += static_cast<int>(mine.events);
    expect_admissible(a);
    if (!exact.converged || !mine.converged) continue;
    for (std::size_t i = 0; i < a.blocks.size(); ++i) {
      if (a.blocks[i].law->event == nullptr) continue;
      if (a.blocks[i].mode != b.blocks[i].mode || a.blocks[i].mode != c.blocks[i].mode) {
        ++wrong;
        ADD_FAILURE() << "seed " << seed << " block " << i << " " << a.blocks[i].law->name;
      }
    }
    // 1e-5 * 1e-4 m over the smallest own compliance 2e-3 m/N, times the coupling of up to 100
    // rows.
    EXPECT_LT((a.lambda - b.lambda).lpNorm<Eigen::Infinity>(), 5e-5) << seed;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(unsolved, 0);
  EXPECT_EQ(unsolved_reference, 0);
  EXPECT_GT(events, 200);
}

TEST(RandomProblems, RotationAndUnitOfLengthChangeNothing) {
  // A normalised quaternion of four normal numbers is a rotation without preferred direction.
  std::mt19937_64 random(3);
  std::normal_distribution<Real> normal;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const Real w = normal(random), x = normal(random), y = normal(random), z = normal(random);
    const Mat3 turn = Quat(w, x, y, z).normalized().toRotationMatrix();
    ConstraintProblem a = random_scene(seed).problem, b = random_scene(seed, turn).problem,
                      c = random_scene(seed, Mat3::Identity(), 1000).problem;
    for (ConstraintProblem* p : {&a, &b, &c})
      ASSERT_TRUE(BlockGaussSeidel({.tolerance = 1e-6}).solve(*p).converged) << seed;
    for (std::size_t i = 0; i < a.blocks.size(); ++i) {
      const ConstraintBlock& block = a.blocks[i];
      const bool world = block.law == &law_operations<suturing::PunctureLaw> ||
                         block.law == &law_operations<Bilateral<3>>;
      VecX l = a.lambda.segment(block.first_row, block.law->dim);
      EXPECT_LT((c.lambda.segment(block.first_row, block.law->dim) - l).norm(), 1e-5) << seed;
      if (world) l.head<3>() = Vec3(turn * l.head<3>());
      EXPECT_LT((b.lambda.segment(block.first_row, block.law->dim) - l).norm(), 1e-5) << seed;
      EXPECT_EQ(a.blocks[i].mode, b.blocks[i].mode) << seed;
      EXPECT_EQ(a.blocks[i].mode, c.blocks[i].mode) << seed;
    }
  }
}

TEST(RandomProblems, FrictionDoesNotDependOnTheNumberOfSweeps) {
  // An earlier research code's friction was 2 % of its value after 10 sweeps and 86 % after 1000.
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::vector<VecX> lambda;
    for (const Index sweeps : {20, 100, 2000}) {
      ConstraintProblem p = random_scene(seed).problem;
      ASSERT_TRUE(BlockGaussSeidel({.tolerance = 1e-6, .sweeps = sweeps}).solve(p).converged)
          << seed << " " << sweeps;
      lambda.push_back(p.lambda);
    }
    EXPECT_LT((lambda[0] - lambda[2]).norm(), 1e-5);
    EXPECT_LT((lambda[1] - lambda[2]).norm(), 1e-5);
  }
}

}  // namespace
