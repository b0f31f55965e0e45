// The worker as it should not be: slow, silent, failing. A block clamped at one side swings under
// its weight; whatever the worker does, the motion is the same.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <limits>
#include <thread>

#include "../../unit/tissue/solver_fixture.h"
#include "async_solver.h"
#include "direct_solver.h"

namespace sutura::tissue {
namespace {

using testing::Swing;

Swing block() {
  Swing s(testing::make_grid(8, 3, 3, 0.005));
  s.material.young = 3e3;
  return s;
}

/// Moves by so much that the factor must be renewed all the time.
AsyncOptions eager() {
  AsyncOptions o;
  o.tolerance = 1e-8;
  o.refactor_iterations = 1;
  return o;
}

std::vector<Vec3> run(TissueSolver& solver, int steps, Swing s = block()) {
  s.begin(solver);
  for (int k = 0; k < steps; ++k) s.step(solver);
  return s.x;
}

Real distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  Real worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, (a[i] - b[i]).norm());
  return worst;
}

/// Sleeps 0 to 3 ms before each factorisation, by a rule of its own.
FactorWorker::Hook slow(unsigned seed) {
  return [seed](Index step) {
    const auto wait = (static_cast<unsigned>(step) * 2654435761u + seed * 40503u) >> 8;
    std::this_thread::sleep_for(std::chrono::microseconds(wait % 3000));
    return true;
  };
}

class FixedLag : public ::testing::TestWithParam<Real> {};

TEST_P(FixedLag, RepeatsBitByBitHoweverSlowTheWorker) {
  AsyncOptions o = eager();
  o.tolerance = GetParam();
  o.lag = 3;
  AsyncSolver first(o);
  const auto x = run(first, 40);
  ASSERT_GT(first.adoptions().size(), 8u);
  for (const Adoption& a : first.adoptions())
    EXPECT_TRUE(a.step == a.snapshot + 3 || a.step == 0) << a.step;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    o.hook = slow(seed);
    AsyncSolver again(o);
    EXPECT_EQ(run(again, 40), x);
    EXPECT_EQ(again.adoptions(), first.adoptions());
  }
}

// 1e-4 preconditions in single precision, 1e-8 in double.
INSTANTIATE_TEST_SUITE_P(Tolerances, FixedLag, ::testing::Values(1e-4, 1e-8),
                         [](const auto& info) { return info.index == 0 ? "coarse" : "fine"; });

TEST(Worker, SeveralBodiesDoNotDisturbEachOther) {
  AsyncOptions o = eager();
  o.lag = 2;
  AsyncSolver alone(o);
  const auto x = run(alone, 25);
  for (const int bodies : {2, 4}) {
    std::vector<std::thread> simulations;
    std::atomic<int> equal = 0;
    for (int k = 0; k < bodies; ++k)
      simulations.emplace_back([&] {
        AsyncSolver solver(o);
        equal += run(solver, 25) == x ? 1 : 0;
      });
    for (auto& s : simulations) s.join();
    EXPECT_EQ(equal, bodies);
  }
}

TEST(Worker, FreeRunningStaysWithTheDirectSolver) {
  SynchronousSolver direct;
  const auto exact = run(direct, 40);
  for (unsigned seed = 1; seed <= 3; ++seed) {
    AsyncOptions o = eager();
    o.hook = slow(seed);
    AsyncSolver solver(o);
    // Each step errs by 1e-8 of the change of velocity; over 40 steps of free swinging motion
    // (displacement some centimetres) that adds up to less than a micrometre.
    EXPECT_LT(distance(run(solver, 40), exact), 1e-6);
  }
}

// E12: adoption at random times, replayed from the log.
TEST(Worker, AnyRunCanBeReplayedFromItsLog) {
  AsyncOptions o = eager();
  o.hook = slow(5);
  AsyncSolver live(o);
  const auto x = run(live, 60);
  o.replay = live.adoptions();
  o.hook = slow(9);
  AsyncSolver replayed(o);
  EXPECT_EQ(run(replayed, 60), x);
  EXPECT_EQ(replayed.adoptions(), live.adoptions());
}

// E12: the rest position under weight must not depend on the delays.
TEST(Worker, TheStaticResultDoesNotDependOnTheDelays) {
  Swing s = block();
  s.material.young = 10e3;
  s.h = 0.05;  // implicit Euler damps strongly at this step
  SynchronousSolver direct;
  const auto exact = run(direct, 250, s);
  for (const Index lag : {1, 50}) {
    AsyncOptions o;
    o.tolerance = 1e-4;
    o.lag = lag;
    AsyncSolver solver(o);
    // 1e-5 of the length, 40 mm.
    EXPECT_LT(distance(run(solver, 250, s), exact), 4e-7) << lag;
  }
}

TEST(Worker, OneThatNeverAnswersIsReplacedByTheStepItself) {
  AsyncOptions o = eager();
  o.lag = 2;
  AsyncSolver sound(o);
  const auto x = run(sound, 20);
  o.hook = [](Index) { return false; };
  o.patience = 0.02;
  AsyncSolver solver(o);
  Swing s = block();
  s.begin(solver);
  bool said = false;
  for (int k = 0; k < 20; ++k) {
    s.step(solver);
    said = said || solver.report().message.find("did not answer") != std::string::npos;
  }
  EXPECT_EQ(s.x, x);
  EXPECT_TRUE(said);
}

/// Ends the process while its worker is at work: with 0 if that was waited for.
[[noreturn]] void end_at_work() {
  static std::atomic<bool> begun = false, finished = false;
  std::atexit([] {  // handlers run in the reverse order: after that of the worker
    if (!finished) std::_Exit(3);
  });
  AsyncOptions o = eager();
  o.hook = [](Index) {
    begun = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    finished = true;
    return true;
  };
  AsyncSolver solver(o);
  Swing s = block();
  s.begin(solver);
  while (!begun) s.step(solver);
  std::exit(0);
}

// The libraries that a factorisation needs clean up when a process ends.
TEST(Worker, AProcessThatEndsWaitsForIt) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(end_at_work(), ::testing::ExitedWithCode(0), "");
}

/// 60 steps with a worker that never answers. `look` sees the report of every step.
std::vector<Vec3> unanswered(AsyncOptions o,
                             const std::function<void(const TissueSolveReport&)>& look) {
  o.hook = [](Index) { return false; };
  AsyncSolver solver(o);
  Swing s = block();
  s.begin(solver);
  for (int k = 0; k < 60; ++k) {
    s.step(solver);
    EXPECT_TRUE(solver.report().converged) << k;
    look(solver.report());
  }
  return s.x;
}

TEST(Worker, FreeRunningWithoutAnswersGrowsStaleAndSaysSo) {
  SynchronousSolver direct;
  const auto exact = run(direct, 60);
  AsyncOptions o = eager();
  o.max_age = 10;
  int stale = 0, said = 0;
  const auto x = unanswered(o, [&](const TissueSolveReport& r) {
    stale += r.stale;
    said += r.message.find("the worker is late") != std::string::npos;
    EXPECT_EQ(r.stale, r.factor_age > 10);
  });
  // The only factor is that of step 0: older than ten steps from step 11 on.
  EXPECT_EQ(stale, 49);
  EXPECT_EQ(said, 49);
  EXPECT_LT(distance(x, exact), 1e-6);  // as for the worker that answers
}

TEST(Worker, FreeRunningWithoutAnswersFactorisesAtOnceWhenTheFactorIsTooPoor) {
  SynchronousSolver direct;
  const auto exact = run(direct, 60);
  AsyncOptions o = eager();
  o.max_iterations = 6;
  int at_once = 0;
  const auto x = unanswered(o, [&](const TissueSolveReport& r) {
    const bool said = r.message.find("at once") != std::string::npos;
    at_once += said;
    EXPECT_EQ(r.factor_age == 0 && r.iterations > 6, said);
  });
  EXPECT_GT(at_once, 0);
  EXPECT_LT(distance(x, exact), 1e-6);
}

TEST(Worker, AFailedFactorisationKeepsTheOlderFactor) {
  AsyncOptions o = eager();
  o.lag = 1;
  AsyncSolver solver(o);
  Swing s = block();
  s.begin(solver);
  for (int k = 0; k < 5; ++k) s.step(solver);
  const Index before = solver.report().adopted_at;
  // A step whose matrix is indefinite at one node, as an element model gone wrong would give.
  MatX b = s.right_hand_side();
  NodeMatrix bad = s.A;
  bad.values()[9 * bad.pattern()->diagonal(40)] *= -1;
  solver.prepare(bad, s.rotations, s.count++);
  solver.solve(b);
  EXPECT_FALSE(solver.report().converged);
  EXPECT_FALSE(solver.report().message.empty());
  EXPECT_TRUE(b.allFinite());
  for (int k = 0; k < 5; ++k) s.step(solver);
  EXPECT_GE(solver.report().failed_factors, 1);
  EXPECT_TRUE(solver.report().converged);
  EXPECT_GT(solver.report().adopted_at, before);
}

TEST(Worker, WithoutAnyFactorItTriesTheDiagonal) {
  AsyncSolver solver(eager());
  Swing s = block();
  s.begin(solver);
  MatX b = s.right_hand_side();
  NodeMatrix bad = s.A;
  bad.values()[9 * bad.pattern()->diagonal(40)] = std::numeric_limits<Real>::quiet_NaN();
  solver.prepare(bad, s.rotations, s.count++);
  solver.solve(b);
  EXPECT_FALSE(solver.report().converged);
  EXPECT_EQ(solver.report().failed_factors, 1);
  b = s.right_hand_side();
  s.step(solver);  // the next matrix is sound
  EXPECT_TRUE(solver.report().converged);
  EXPECT_EQ(solver.report().iterations, 1);
}

TEST(Worker, AFlungBodyCostsNoIterations) {
  // Turned by half a turn in one step: the warped factor is exact.
  AsyncOptions o = eager();
  o.tolerance = 1e-9;
  o.hook = [](Index) { return false; };
  AsyncSolver solver(o);
  Swing s = block();
  s.begin(solver);
  MatX b = s.right_hand_side();
  solver.prepare(s.A, s.rotations, 0);
  const Eigen::AngleAxis<Real> turn(3.141592653589793, Vec3(1, -1, 2).normalized());
  for (Vec3& x : s.x) x = turn * x;
  b = s.right_hand_side();
  solver.prepare(s.A, s.rotations, 1);
  solver.solve(b);
  EXPECT_EQ(solver.report().iterations, 1);
  EXPECT_EQ(solver.report().factor_age, 1);
}

}  // namespace
}  // namespace sutura::tissue
