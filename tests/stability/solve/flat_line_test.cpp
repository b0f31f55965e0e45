// A stiff line comes to lie on uneven ground and touches it nearly everywhere at once: the hardest
// question for a solver of contacts is then which few of them carry it. A thread that lands on
// tissue asks it.
#include <gtest/gtest.h>

#include <cmath>

#include "solve/gauss_seidel.h"
#include "solve_problems.h"
#include "sutura/laws/coulomb.h"

namespace sutura::test {
namespace {

struct Line {
  int nodes;
  Real bending;  ///< N/m: against a bend, from node to node
  Real ground;   ///< m/N: how soft it is
  Real waves;    ///< m: how high
};

/// Every node touches: normal, along the line, across. Friction acts at the surface and so turns
/// the line, which couples the first two.
ConstraintProblem lands(const Line& line, Real mu) {
  constexpr Real mass = 1e-4, stretching = 1e5, arm = 0.3;  // N/m, N/m, in spacings of nodes
  const Index n = line.nodes;
  MatX across = mass * MatX::Identity(n, n), along = across, slope = MatX::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    VecX bend = VecX::Zero(n), stretch = VecX::Zero(n);
    if (i > 0 && i + 1 < n) {
      bend[i - 1] = bend[i + 1] = 1, bend[i] = -2;
      across += line.bending * bend * bend.transpose();
    }
    if (i + 1 < n) {
      stretch[i] = -1, stretch[i + 1] = 1;
      along += stretching * stretch * stretch.transpose();
    }
    const Index before = std::max<Index>(i - 1, 0), after = std::min(i + 1, n - 1);
    slope(i, after) += arm / static_cast<Real>(after - before);
    slope(i, before) -= arm / static_cast<Real>(after - before);
  }
  const MatX normal = across.inverse(), coupled = normal * slope.transpose();
  const MatX tangent = along.inverse() + slope * coupled;

  ConstraintProblem p;
  MatX W = MatX::Zero(3 * n, 3 * n);
  VecX d(3 * n);
  for (Index i = 0; i < n; ++i) {
    append<Coulomb>(p, {.mu = mu});
    for (Index j = 0; j < n; ++j) {
      const Real near = std::exp(-0.5 * std::abs(static_cast<Real>(i - j)));
      const Mat3 soft = line.ground * (i == j ? 1.05 : near) * Mat3::Identity();
      W.block<3, 3>(3 * i, 3 * j) += soft;
      W(3 * i, 3 * j) += normal(i, j);
      W(3 * i + 2, 3 * j + 2) += normal(i, j);
      W(3 * i + 1, 3 * j + 1) += tangent(i, j);
      W(3 * i, 3 * j + 1) += coupled(i, j);
      W(3 * j + 1, 3 * i) += coupled(i, j);
    }
    const Real wave = std::abs(static_cast<Real>((i + 3) % 11) / 11 - 0.5);
    const Real place = static_cast<Real>(i) / static_cast<Real>(n);
    d.segment<3>(3 * i) << -1e-3 + line.waves * wave, 4e-6 * (1 - 2 * place) + 1e-8, 1e-6;
  }
  finish(p, W, d);
  return p;
}

// Where all states changed at once, 8 to 12 of these 24 went in circles, and 1000 sweeps did not
// help (which of them, rounding decided).
TEST(FlatLine, ItIsFoundWhatCarriesIt) {
  for (const int nodes : {40, 80, 160})
    for (const Real bending : {1e2, 1e4})
      for (const Real waves : {1e-6, 1e-5})
        for (const Real ground : {1e-6, 1e-4}) {
          ConstraintProblem p = lands({nodes, bending, ground, waves}, 0.3);
          const SolveReport report = BlockGaussSeidel().solve(p);
          EXPECT_TRUE(report.converged) << nodes << ' ' << bending << ' ' << waves << ' ' << ground;
          EXPECT_LT(report.sweeps, 100);
          // The lowest places, every 11 nodes.
          Index carries = 0;
          for (Index i = 0; i < nodes; ++i) carries += p.lambda[3 * i] > 0;
          EXPECT_LT(carries, nodes / 4);
        }
}

}  // namespace
}  // namespace sutura::test
