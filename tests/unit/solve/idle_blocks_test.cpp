// Blocks that a pass leaves out (idle_blocks.h): what is left is the problem without them, and with
// those that wake the solution is that of all blocks.
#include "solve/idle_blocks.h"

#include <gtest/gtest.h>

#include "solve/gauss_seidel.h"
#include "solve_problems.h"
#include "sutura/laws/coulomb.h"
#include "sutura/laws/unilateral.h"

namespace sutura::test {
namespace {

constexpr Real beyond = 0.1;

/// Rows of unit masses: row i pushes node i, three rows a block. Gaps as given.
ConstraintProblem touches(const std::vector<Real>& gaps) {
  ConstraintProblem p;
  for (std::size_t i = 0; i < gaps.size(); ++i) append<Coulomb>(p, {.mu = 0.3});
  const auto rows = static_cast<Index>(3 * gaps.size());
  VecX d = VecX::Zero(rows);
  for (std::size_t i = 0; i < gaps.size(); ++i) d[static_cast<Index>(3 * i)] = gaps[i];
  finish(p, MatX::Identity(rows, rows), d);
  for (ConstraintBlock& b : p.blocks) b.idle_beyond = beyond;
  BodyRows& H = p.bodies.emplace_back();
  H.clear();
  for (Index i = 0; i < rows; ++i) {
    H.row.push_back(i);
    H.node.push_back(i);
    for (const Real x : {1., 0., 0.}) H.value.push_back(x);
    H.start.push_back(i + 1);
  }
  return p;
}

TEST(IdleBlocks, LeavesOutWhatIsOpenAndCarriesNothing) {
  ConstraintProblem p = touches({-0.2, 0.2, 0.05, 0.3});
  p.lambda[9] = 1e-9;  // open, but it carries
  IdleBlocks idle(1);
  idle.find(p);
  const ConstraintProblem& others = idle.without(p);
  ASSERT_EQ(others.blocks.size(), 3u);
  EXPECT_EQ(others.blocks[1].key, p.blocks[2].key);
  EXPECT_EQ(others.blocks[2].first_row, 6);
  EXPECT_EQ(others.gap[3], 0.05);
  EXPECT_EQ(others.lambda[6], 1e-9);
  // Rows have new numbers, and press where they did.
  EXPECT_EQ(others.bodies[0].row, (std::vector<Index>{0, 1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(others.bodies[0].node, (std::vector<Index>{0, 1, 2, 6, 7, 8, 9, 10, 11}));
}

TEST(IdleBlocks, NothingIdlesUnlessItMay) {
  ConstraintProblem p = touches({1, 2});
  p.blocks[1].idle_beyond = std::numeric_limits<Real>::infinity();
  IdleBlocks idle(1);
  idle.find(p);
  EXPECT_EQ(idle.without(p).blocks.size(), 1u);
}

// Random couplings of six touches, of which some close only as others push them together. As a pass
// does: what is not idle is solved, d_free becomes what that leads the gaps to, what that closes
// wakes.
TEST(IdleBlocks, WithThoseThatWakeItIsTheSolutionOfAll) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<Real> gap(-0.3, 0.2);
  Index woken = 0, idled = 0;
  for (int draw = 0; draw < 500; ++draw) {
    std::vector<Real> gaps(6);
    for (Real& g : gaps) g = gap(random);
    ConstraintProblem all = touches(gaps);
    all.W = random_spd<18>(random) / 18;
    ConstraintProblem p = all;

    BlockGaussSeidel solver({.tolerance = 1e-11});
    ASSERT_TRUE(solver.solve(all).converged);
    IdleBlocks idle(1);
    idle.find(p);
    Index rounds = 0;
    for (bool goes_on = true; goes_on; goes_on = idle.wake(p), ++rounds) {
      ConstraintProblem& others = idle.without(p);
      idled += static_cast<Index>(p.blocks.size() - others.blocks.size());
      others.W.resize(others.rows(), others.rows());
      const auto of = [&](Index row) {
        return others.bodies[0].node[static_cast<std::size_t>(row)];
      };
      for (Index i = 0; i < others.rows(); ++i)
        for (Index j = 0; j < others.rows(); ++j) others.W(i, j) = p.W(of(i), of(j));
      // d_free holds what the forces so far do.
      const VecX before = others.lambda;
      others.d_free -= others.W * before;
      ASSERT_TRUE(solver.solve(others).converged);
      const VecX forces = p.lambda;
      idle.put_back(p);
      p.d_free += p.W * (p.lambda - forces);
    }
    woken += rounds - 1;
    // Both are solved to 1e-11 of 0.1 N, and Coulomb's law may have several solutions: then gaps
    // and forces of this one have to obey it.
    for (const ConstraintBlock& b : p.blocks) {
      const Real opening = p.d_free[b.first_row], force = p.lambda[b.first_row];
      EXPECT_GE(opening, -1e-9);
      EXPECT_GE(force, 0);
      EXPECT_LE(std::min(opening, force), 1e-9);
      EXPECT_LE(p.lambda.segment<2>(b.first_row + 1).norm(), 0.3 * force * (1 + 1e-9) + 1e-12);
      EXPECT_EQ(static_cast<Friction>(b.mode) == Friction::open, force == 0);
    }
  }
  EXPECT_GT(idled, 100);
  EXPECT_GT(woken, 5);
}

}  // namespace
}  // namespace sutura::test
