// reference/c02: complementarity and Coulomb problems whose solutions come from enumeration of all
// cases.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "solve/gauss_seidel.h"
#include "solve/reference_solver.h"
#include "solve_problems.h"
#include "sutura/laws/coulomb.h"
#include "sutura/laws/unilateral.h"

using namespace sutura;
using namespace sutura::test;

namespace {

// The problems have W and q of order one, without units.
constexpr BlockUnits unit_scale{.force = 1, .length = 1};

nlohmann::json problems() {
  std::ifstream in(SUTURA_SOURCE_DIR "/tests/reference/c02_contact_problems.json");
  return nlohmann::json::parse(in);
}
VecX vector_of(const nlohmann::json& j) {
  const auto v = j.get<std::vector<Real>>();
  return Eigen::Map<const VecX>(v.data(), static_cast<Index>(v.size()));
}
MatX matrix_of(const nlohmann::json& j) {
  MatX m(j.size(), j.size());
  for (std::size_t i = 0; i < j.size(); ++i)
    m.row(static_cast<Index>(i)) = vector_of(j[i]).transpose();
  return m;
}

ConstraintProblem lcp(const nlohmann::json& j) {
  ConstraintProblem p;
  for (std::size_t i = 0; i < j["q"].size(); ++i) append<Unilateral>(p, {}, 0, unit_scale);
  finish(p, matrix_of(j["W"]), vector_of(j["q"]));
  return p;
}
ConstraintProblem coulomb(const nlohmann::json& j) {
  ConstraintProblem p;
  for (const Real mu : j["mu"].get<std::vector<Real>>())
    append<Coulomb>(p, {.mu = mu}, 0, unit_scale);
  finish(p, matrix_of(j["W"]), vector_of(j["q"]));
  return p;
}

/// Largest violation of the Coulomb law, from W, q and lambda alone.
Real coulomb_error(const ConstraintProblem& p) {
  const VecX delta = p.W * p.lambda + p.d_free;
  Real worst = 0;
  for (const ConstraintBlock& b : p.blocks) {
    const Real mu = static_cast<const Coulomb::Params*>(p.block_params(b))->mu;
    const Vec3 l = p.lambda.segment<3>(b.first_row), d = delta.segment<3>(b.first_row);
    // Projection form with the cone of the present normal force (no dilatancy).
    const Real ln = std::max(Real(0), l[0] - d[0]);
    Vec2 lt = l.tail<2>() - d.tail<2>();
    if (lt.norm() > mu * ln) lt *= mu * ln / lt.norm();
    worst = std::max({worst, std::abs(ln - l[0]), (lt - l.tail<2>()).norm()});
  }
  return worst;
}

TEST(ContactProblems, LinearComplementarity) {
  const auto all = problems()["lcp"];
  ASSERT_EQ(all.size(), 16u);
  for (const auto& j : all) {
    const VecX expected = vector_of(j["lambda"]);
    ConstraintProblem p = lcp(j);
    EXPECT_TRUE(ReferenceSolver({.tolerance = 1e-12}).solve(p).converged) << j["name"];
    EXPECT_LT((p.lambda - expected).norm(), 1e-8 * (1 + expected.norm())) << j["name"];
    for (const Acceleration a : {Acceleration::none, Acceleration::nncg, Acceleration::subspace}) {
      ConstraintProblem q = lcp(j);
      // 1e-10: the smallest eigenvalue of these W is about 1e-2, so lambda is right to 1e-8.
      const SolveReport report =
          BlockGaussSeidel({.tolerance = 1e-10, .sweeps = 20000, .acceleration = a}).solve(q);
      EXPECT_TRUE(report.converged) << j["name"];
      EXPECT_LT((q.lambda - expected).norm(), 1e-7 * (1 + expected.norm())) << j["name"];
    }
  }
}

TEST(ContactProblems, CoulombByTheReferenceSolver) {
  const auto all = problems()["coulomb"];
  ASSERT_EQ(all.size(), 22u);
  for (const auto& j : all) {
    ConstraintProblem p = coulomb(j);
    const SolveReport report = ReferenceSolver({.tolerance = 1e-10}).solve(p);
    EXPECT_TRUE(report.converged) << j["name"] << " " << report.residual;
    EXPECT_LT(coulomb_error(p), 1e-8) << j["name"];
    // Rank-deficient ones have many lambda; W lambda is what they share.
    const VecX expected = vector_of(j["lambda"]);
    const bool large = p.blocks.size() >= 10;
    if (!large) {
      EXPECT_LT((p.lambda - expected).norm(), 1e-8 * (1 + expected.norm())) << j["name"];
    }
    RecordProperty(j["name"].get<std::string>().substr(0, 9), static_cast<int>(report.sweeps));
  }
}

TEST(ContactProblems, CoulombByGaussSeidel) {
  const auto all = problems()["coulomb"];
  ASSERT_EQ(all.size(), 22u);
  for (const auto& j : all) {
    const bool large = j["mu"].size() >= 10;
    for (const Acceleration a : {Acceleration::none, Acceleration::nncg, Acceleration::subspace}) {
      ConstraintProblem p = coulomb(j);
      const Real tolerance = large ? 1e-6 : 1e-10;
      const SolveReport report =
          BlockGaussSeidel({.tolerance = tolerance, .sweeps = 2000, .acceleration = a}).solve(p);
      EXPECT_TRUE(report.converged)
          << j["name"] << " " << static_cast<int>(a) << " " << report.residual;
      // The natural map here is scaled differently from the solver's; the condition of W is about
      // 1e2.
      EXPECT_LT(coulomb_error(p), 100 * tolerance) << j["name"];
      const VecX expected = vector_of(j["lambda"]);
      if (!large) {
        EXPECT_LT((p.lambda - expected).norm(), 1e-7 * (1 + expected.norm())) << j["name"];
        std::string states;
        for (const ConstraintBlock& b : p.blocks) states += "OKS"[b.mode];
        // The state of a contact at the edge of its cone is stick or slip by rounding: case 2 is
        // built so.
        if (j["name"] != "one contact W=I q=(-1,0.3,0) mu=0.3") {
          EXPECT_EQ(states, j["state"].get<std::string>()) << j["name"];
        }
      }
    }
  }
}

}  // namespace
