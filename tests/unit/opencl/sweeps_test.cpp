// Gauss-Seidel on a device is the Gauss-Seidel of the CPU: the same sweeps in the same order.
#include <Eigen/LU>
#include <random>

#include "opencl_device.h"
#include "solve/gauss_seidel.h"
#include "solve_problems.h"
#include "some_device.h"
#include "sutura/laws/coulomb.h"
#include "sutura/laws/unilateral.h"
#include "sweeps_alone.h"

namespace sutura::opencl {
namespace {

/// Blocks of all sizes that scenes have, coupled all with all, none more than they resist.
ConstraintProblem mixed_problem(int blocks, bool with_six_rows = false) {
  std::mt19937_64 random(static_cast<unsigned>(blocks));
  std::uniform_real_distribution<Real> some(-1, 1);
  ConstraintProblem p;
  for (int i = 0; i < blocks; ++i) {
    if (i % 4 == 0)
      test::append<Coulomb>(p, {.mu = 0.3});
    else if (i % 4 == 1)
      test::append<Bilateral<2>>(p, {.cap = i % 8 == 1 ? 0.5 : 100});
    else if (i % 4 == 2)
      test::append<suturing::PathFrictionLaw>(
          p, {.static_level = 0.3, .kinetic = 0.2, .viscous = 0.1, .stick_slip = 0.1});
    else if (with_six_rows)
      test::append<Bilateral<6>>(p, {});
    else
      test::append<Unilateral>(p, {});
    p.blocks.back().units = {.force = 1, .length = 1};  // what the numbers below are about
  }
  const Index rows = p.blocks.back().first_row + p.blocks.back().law->dim;
  MatX B(rows, rows);
  for (Index i = 0; i < B.size(); ++i) B.data()[i] = some(random);
  MatX W = B * B.transpose() / static_cast<Real>(rows);
  W.diagonal().array() += 1;
  VecX d(rows);
  for (Index i = 0; i < rows; ++i) d[i] = some(random);
  test::finish(p, W, d);
  return p;
}

/// As a scene gives it.
std::unique_ptr<OpenClDevice> component(Precision precision = Precision::automatic,
                                        OnFailure on_failure = OnFailure::stop) {
  auto out = std::make_unique<OpenClDevice>();
  out->precision = precision;
  out->on_failure = on_failure;
  Diagnostics diagnostics;
  Setup setup{.diagnostics = diagnostics, .scene_directory = {}, .output_directory = {}};
  out->initialise(setup);
  EXPECT_TRUE(diagnostics.ok());
  return out;
}

Real difference(const VecX& a, const VecX& b) {
  return (a - b).lpNorm<Eigen::Infinity>() / b.lpNorm<Eigen::Infinity>();
}

class DeviceSweeps : public OnDevice {
 protected:
  void SetUp() override {
    OnDevice::SetUp();
    if (device_ && !device_->has_double()) GTEST_SKIP() << "no double precision";
  }
};

// A scene may end with a problem loaded and not swept: kernels that still run then had their memory
// taken away, in 7 % of the runs on a loaded machine.
TEST_F(DeviceSweeps, MayGoWithTheirProblemWhileTheDeviceWorks) {
  const ConstraintProblem some = mixed_problem(128);
  for (int i = 0; i < 50; ++i) {
    auto problem = std::make_unique<ConstraintProblem>(some);
    const Device device({});
    Sweeps sweeps(device, choose(Precision::automatic, device));
    EXPECT_EQ(sweeps.load(*problem), "");
    problem.reset();
  }
}

// Sums are added in another order only, so rounding is all that differs; it is carried from block
// to block and sweep to sweep.
TEST_F(DeviceSweeps, AreThoseOfTheCpu) {
  for (const int in_one_group : {10, 300})
    for (const int blocks : {2, 3, 9, 33, 64, 65, 150}) {
      SCOPED_TRACE(std::to_string(blocks) + " blocks, one group up to " +
                   std::to_string(in_one_group));
      ConstraintProblem ours = mixed_problem(blocks);
      ours.hold_events = true;  // of the half of a budget this small
      ConstraintProblem theirs = ours;
      BlockGaussSeidel cpu({.tolerance = 1e-300, .sweeps = 8, .acceleration = Acceleration::none});
      cpu.solve(ours);

      Sweeps sweeps(*device_, Precision::double_, in_one_group);
      SweepsAlone alone(sweeps, Precision::double_);
      BlockGaussSeidel there = cpu;
      there.set_device(&alone);
      const SolveReport report = there.solve(theirs);
      EXPECT_EQ(there.trouble(), "");
      EXPECT_EQ(report.sweeps, 8);
      EXPECT_LT(difference(theirs.lambda, ours.lambda), 1e-12);
      EXPECT_LT(difference(theirs.delta, ours.delta), 1e-12);
      for (std::size_t i = 0; i < ours.blocks.size(); ++i)
        EXPECT_EQ(theirs.blocks[i].mode, ours.blocks[i].mode) << i;
    }
}

TEST_F(DeviceSweeps, TakeBlocksOfSixRows) {
  ConstraintProblem ours = mixed_problem(30, true), theirs = ours;
  BlockGaussSeidel cpu({.tolerance = 1e-11, .acceleration = Acceleration::none}), there = cpu;
  EXPECT_TRUE(cpu.solve(ours).converged);
  const auto device = component();
  there.set_device(device.get());
  EXPECT_TRUE(there.solve(theirs).converged);
  EXPECT_EQ(there.trouble(), "");
  EXPECT_LT(difference(theirs.lambda, ours.lambda), 1e-10);
}

TEST_F(DeviceSweeps, RepeatBitByBit) {
  for (const int blocks : {40, 400}) {
    ConstraintProblem first = mixed_problem(blocks), second = first;
    const auto device = component();
    BlockGaussSeidel solver({.tolerance = 1e-9, .acceleration = Acceleration::none});
    solver.set_device(device.get());
    EXPECT_TRUE(solver.solve(first).converged);
    solver.solve(second);
    EXPECT_TRUE(first.lambda == second.lambda);
  }
}

// The targets of precision: 1e-6 of the force in double, 1e-4 in single. With the direct step,
// which the CPU does, all of them end at the tolerance of the solver.
TEST_F(DeviceSweeps, SolveAStitchInEveryPrecision) {
  const ConstraintProblem stitch = test::stitch({.samples = 50, .pull = 0.3});
  ConstraintProblem ours = stitch;
  BlockGaussSeidel cpu, there;
  const SolveReport on_cpu = cpu.solve(ours);
  ASSERT_TRUE(on_cpu.converged);
  for (const Precision precision : {Precision::double_, Precision::mixed, Precision::single}) {
    ConstraintProblem theirs = stitch;
    const auto device = component(precision);
    there.set_device(device.get());
    const SolveReport report = there.solve(theirs);
    EXPECT_TRUE(report.converged);
    EXPECT_EQ(there.trouble(), "");
    EXPECT_EQ(report.events, on_cpu.events);
    EXPECT_LT(difference(theirs.lambda, ours.lambda), 1e-6);
  }
}

/// Counts what the device is asked for.
class Counted : public SweepsAlone {
 public:
  using SweepsAlone::SweepsAlone;
  bool solve_tangents(const TangentSystem& system, TangentAnswer& answer) override {
    ++solved;
    most = std::max(most, system.scale.size());
    return SweepsAlone::solve_tangents(system, answer);
  }
  int solved = 0;
  std::size_t most = 0;
};

// 150 rows and more of a thread that is almost free, whose sweeps alone would not end; systems of
// sizes that fill their tiles and of others. Only rounding differs, times the condition of W.
TEST_F(DeviceSweeps, DoTheDirectStepAsTheCpuDoes) {
  for (const int samples : {50, 64, 101})
    for (const Real pull : {0.1, 0.3}) {
      SCOPED_TRACE(std::to_string(samples) + " samples, " + std::to_string(pull) + " N");
      const ConstraintProblem stitch = test::stitch({.samples = samples, .pull = pull});
      ConstraintProblem ours = stitch, theirs = stitch, again = stitch;
      BlockGaussSeidel cpu({.tolerance = 1e-8}), there = cpu;
      const SolveReport on_cpu = cpu.solve(ours);
      Sweeps sweeps(*device_, Precision::double_);
      Counted counted(sweeps, Precision::double_);
      there.set_device(&counted);
      const SolveReport report = there.solve(theirs);
      EXPECT_TRUE(on_cpu.converged) << on_cpu.residual;
      EXPECT_TRUE(report.converged) << report.residual << ", CPU " << on_cpu.residual;
      EXPECT_EQ(report.events, on_cpu.events);
      EXPECT_GT(counted.solved, 0);
      EXPECT_GE(counted.most, 100U);
      EXPECT_LT(difference(theirs.lambda, ours.lambda), 1e-7);
      there.solve(again);
      EXPECT_TRUE(again.lambda == theirs.lambda) << "not the same bits";
    }
}

// Rows that say the same twice: elimination meets a pivot of 1e-12, and what comes of it is not
// taken unless it solves the equations.
TEST_F(DeviceSweeps, DoNotTakeADirectStepThatSolvesNothing) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<Real> some(-1, 1);
  ConstraintProblem p;
  constexpr Index pairs = 80;
  for (Index i = 0; i < 2 * pairs; ++i) test::append<Bilateral<1>>(p, {});
  MatX B(pairs, pairs);
  for (Real& b : B.reshaped()) b = some(random);
  const MatX half = B * B.transpose() + MatX::Identity(pairs, pairs);
  MatX W(2 * pairs, 2 * pairs);
  VecX d(2 * pairs);
  for (Index i = 0; i < 2 * pairs; ++i) {
    d[i] = i % 2 == 0 ? some(random) : d[i - 1];
    for (Index j = 0; j < 2 * pairs; ++j) W(i, j) = half(i / 2, j / 2);
  }
  test::finish(p, W, d);
  Sweeps sweeps(*device_, Precision::double_);
  Counted counted(sweeps, Precision::double_);
  BlockGaussSeidel there;
  there.set_device(&counted);
  EXPECT_TRUE(there.solve(p).converged);
  EXPECT_LT((W * p.lambda + d).lpNorm<Eigen::Infinity>(), 1e-5);
}

// Without the direct step single precision ends where its rounding does; the residual is told as it
// is, since the CPU measures it.
TEST_F(DeviceSweeps, TellHowFarSinglePrecisionGets) {
  ConstraintProblem ours = mixed_problem(60), theirs = ours;
  BlockGaussSeidel cpu({.tolerance = 1e-11, .acceleration = Acceleration::none}), there = cpu;
  there.options().sweeps = 100;
  ASSERT_TRUE(cpu.solve(ours).converged);
  const auto device = component(Precision::single);
  there.set_device(device.get());
  const SolveReport report = there.solve(theirs);
  EXPECT_FALSE(report.converged);
  EXPECT_LT(difference(theirs.lambda, ours.lambda), 1e-4);
  // 24 bits of numbers of about 1 are 6e-8, and each is a sum of some hundred.
  EXPECT_GT(report.residual, 1e-9);
  EXPECT_LT(report.residual, 1e-5);
}

// Mixed precision has no such end: delta is made again from lambda and W as the CPU has them, so
// what W is rounded to changes the way to the solution and not the solution.
TEST_F(DeviceSweeps, EndAtTheSolutionInMixedPrecision) {
  ConstraintProblem ours = mixed_problem(60), theirs = ours;
  BlockGaussSeidel cpu({.tolerance = 1e-12, .acceleration = Acceleration::none}), there = cpu;
  ASSERT_TRUE(cpu.solve(ours).converged);
  const auto device = component(Precision::mixed);
  there.set_device(device.get());
  EXPECT_TRUE(there.solve(theirs).converged);
  EXPECT_EQ(there.trouble(), "");
  // Both are within the tolerance; W rounded to single would leave some 1e-8.
  EXPECT_LT(difference(theirs.lambda, ours.lambda), 1e-11);
}

struct Unknown : Unilateral {
  static constexpr const char* name = "unknown";
};

TEST_F(DeviceSweeps, LeaveALawWithoutTwinToTheCpuOrStop) {
  ConstraintProblem p;
  test::append<Unknown>(p, {});
  test::finish(p, MatX::Ones(1, 1), -VecX::Ones(1));
  BlockGaussSeidel solver;
  const auto lenient = component(Precision::automatic, OnFailure::cpu);
  solver.set_device(lenient.get());
  EXPECT_TRUE(solver.solve(p).converged);
  EXPECT_NEAR(p.lambda[0], 1, 1e-12);
  EXPECT_EQ(solver.trouble(),
            "the law 'unknown' has no twin on the device; the CPU has taken over");
  // And only this problem.
  ConstraintProblem known = mixed_problem(8);
  solver.solve(known);
  EXPECT_EQ(solver.trouble(), "");

  const auto strict = component();
  solver.set_device(strict.get());
  EXPECT_THROW(solver.solve(p), DeviceError);
}

TEST_F(DeviceSweeps, GoOnWhereTheDeviceIsLost) {
  const ConstraintProblem start = mixed_problem(40);
  ConstraintProblem ours = start, theirs = start;
  BlockGaussSeidel cpu, there;
  cpu.solve(ours);
  const auto device = component(Precision::automatic, OnFailure::cpu);
  there.set_device(device.get());
  ConstraintProblem before = start;
  EXPECT_TRUE(there.solve(before).converged);
  device->opened()->lose();
  EXPECT_TRUE(there.solve(theirs).converged);
  EXPECT_TRUE(theirs.lambda == ours.lambda) << "the CPU would have found other bits";
  EXPECT_NE(there.trouble().find("not available"), std::string::npos) << there.trouble();

  const auto strict = component();
  strict->opened()->lose();
  there.set_device(strict.get());
  EXPECT_THROW(there.solve(theirs), DeviceError);
}

TEST(DeviceChoiceTest, SaysWhatThereIs) {
  const std::string list = list_devices();
  EXPECT_NE(list.find('\n'), std::string::npos);
  try {
    const Device none({.name = "no such device"});
    FAIL() << "a device of no name";
  } catch (const DeviceError& e) {
    const std::string said = e.what();
    EXPECT_TRUE(said.find("there is \"") != std::string::npos ||
                said.find("no OpenCL device on this machine") != std::string::npos)
        << said;
  }
}

TEST_F(DeviceSweeps, AProgramThatDoesNotCompileShowsItsLog) {
  try {
    device_->build("kernel void f() { no_such_thing(); }", "");
    FAIL() << "it compiled";
  } catch (const DeviceError& e) {
    EXPECT_NE(std::string(e.what()).find("no_such_thing"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace sutura::opencl
