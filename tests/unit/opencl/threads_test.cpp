// Many threads on a device are the thread of the CPU, many times.
#include "threads.h"

#include <cstring>
#include <numbers>

#include "batch_on_cpu.h"
#include "some_device.h"

namespace sutura::opencl {
namespace {

class DeviceThreads : public OnDevice {
 protected:
  void SetUp() override {
    OnDevice::SetUp();
    if (device_ && !device_->has_double()) GTEST_SKIP() << "no double precision";
  }
  std::vector<Real> observe(Threads& threads) {
    std::vector<Real> out(
        static_cast<std::size_t>(threads.observations() * threads.environments()));
    threads.observe(out);
    return out;
  }
};

/// A bow of path points that the thread, straight at rest, must first be drawn into.
ThreadsProblem bow(int points) {
  ThreadsProblem p;
  p.dt = 2e-3;
  p.gravity = {0, 0, -9.81};
  p.beams = 24;
  p.length = 0.06;
  p.start = {0.01, 0, 0.002};
  p.direction = {1, 0.2, 0};
  p.friction = 0.01;
  for (int k = 0; k < points; ++k) {
    const Vec3 along = Vec3(1, 0.2, 0).normalized() * (0.02 + 0.003 * k);
    const Vec3 x = p.start + along + Vec3(0, 0, 0.0003 * std::sin(0.7 * k));
    for (const Real r : {x.x(), x.y(), x.z()}) p.path.push_back(r);
  }
  return p;
}

// The CPU has the beams, the matrix and its factor of the thread plugin, and rows with laws and
// Gauss-Seidel where the device has springs and pivots. What differs is rounding, which the
// condition of friction on a thread (1e7) carries into forces.
TEST_F(DeviceThreads, StepAsOnTheCpu) {
  const ThreadsProblem p = bow(6);
  Threads threads(*device_, p, 3);
  test::ThreadOnCpu cpu(p);
  Real largest = 0;
  bool stuck = false, slid = false;
  for (int step = 0; step < 60; ++step) {
    // Still, then to and fro: friction sticks, slides and turns about.
    const Vec3 u = step < 10 ? Vec3(0, 0, 0) : Vec3(step < 35 ? 0.05 : -0.03, 0.01, 0.02);
    std::vector<Real> actions;
    for (int e = 0; e < 3; ++e)
      for (int d = 0; d < 3; ++d) actions.push_back(u[d]);
    threads.step(actions, p.dt);
    cpu.step(u);
    const std::vector<Real> seen = observe(threads);
    const Real* row = seen.data() + threads.observations();  // the second environment
    ASSERT_LT(row[3 + p.points()], 1e-9) << "step " << step;
    for (int d = 0; d < 3; ++d) {
      EXPECT_NEAR(row[d], cpu.hand_force()[d], 1e-6) << "step " << step;
      largest = std::max(largest, std::abs(row[d]));
    }
    for (Index k = 0; k < p.points(); ++k) {
      EXPECT_NEAR(row[3 + k], cpu.friction()[k], 1e-6) << "step " << step << ", point " << k;
      (std::abs(cpu.friction()[k]) < 0.99 * p.friction ? stuck : slid) = true;
    }
    for (Index i = 0; i <= p.beams; ++i)
      for (int d = 0; d < 3; ++d)
        ASSERT_NEAR(row[4 + p.points() + 3 * i + d], cpu.position(i)[d], 1e-9)
            << "step " << step << ", node " << i;
  }
  EXPECT_GT(largest, 0.03);
  EXPECT_TRUE(stuck && slid) << "there is something to compare";
}

// Steadily through a straight path: the hand feels the friction of all points and nothing else.
TEST_F(DeviceThreads, ThePullIsTheFriction) {
  ThreadsProblem p;
  p.dt = 5e-3;
  p.beams = 40;
  for (int k = 0; k < 16; ++k)
    for (const Real r : {0.03 + 0.002 * k, 0., 0.}) p.path.push_back(r);
  Threads threads(*device_, p, 1);
  for (int step = 0; step < 200; ++step) threads.step(std::vector<Real>{0.02, 0, 0}, p.dt);
  const std::vector<Real> seen = observe(threads);
  EXPECT_NEAR(seen[0], 16 * p.friction, 1e-6);
  EXPECT_NEAR(seen[1], 0, 1e-9);
  EXPECT_LT(seen[3 + 16], 1e-9);
}

// Hanging from the hand, the path far away from anything it could hold.
TEST_F(DeviceThreads, TheHandCarriesTheWeight) {
  ThreadsProblem p;
  p.gravity = {0, 0, -9.81};
  p.beams = 10;
  p.direction = {0, 0, 1};
  p.lateral = 0;
  p.friction = 0;
  p.path = {0, 0, 0.05};
  Threads threads(*device_, p, 1);
  for (int step = 0; step < 100; ++step) threads.step(std::vector<Real>{0, 0, 0}, p.dt);
  const Real weight = std::numbers::pi / 4 * p.diameter * p.diameter * p.length * p.density * 9.81;
  EXPECT_NEAR(observe(threads)[2], weight, 1e-6 * weight);
}

TEST_F(DeviceThreads, EqualRowsAreEqualToTheBitAndOthersAreNot) {
  const ThreadsProblem p = bow(8);
  constexpr int count = 5, odd = 2;
  Threads threads(*device_, p, count);
  const auto step = [&](Real odd_one) {
    std::vector<Real> actions;
    for (int e = 0; e < count; ++e)
      for (const Real v : {0.04, e == odd ? odd_one : 0.01, 0.}) actions.push_back(v);
    threads.step(actions, p.dt);
  };
  const auto row = [&](const std::vector<Real>& seen, int e) {
    const auto size = static_cast<std::ptrdiff_t>(threads.observations());
    return std::vector<Real>(seen.begin() + e * size, seen.begin() + (e + 1) * size);
  };
  for (int i = 0; i < 20; ++i) step(-0.02);
  std::vector<Real> seen = observe(threads);
  for (int e = 1; e < count; ++e) EXPECT_EQ(row(seen, e) == row(seen, 0), e != odd) << e;
  // From the beginning again, now without an odd one: the same bits in all, and as a single
  // environment has them.
  threads.reset({});
  Threads single(*device_, p, 1);
  for (int i = 0; i < 20; ++i) {
    step(0.01);
    single.step(std::vector<Real>{0.04, 0.01, 0}, p.dt);
  }
  seen = observe(threads);
  for (int e = 0; e < count; ++e) EXPECT_TRUE(row(seen, e) == observe(single)) << e;
  // Only one goes back.
  const std::vector<std::uint8_t> which{0, 0, 1, 0, 0};
  threads.reset(which);
  Threads fresh(*device_, p, 1);
  const std::vector<Real> then = observe(threads);
  for (int e = 0; e < count; ++e)
    EXPECT_TRUE(row(then, e) == (e == odd ? observe(fresh) : row(seen, e))) << e;
}

TEST_F(DeviceThreads, GoOnFromASavedState) {
  const ThreadsProblem p = bow(4);
  Threads first(*device_, p, 2), second(*device_, p, 2);
  const std::vector<Real> actions{0.05, 0, 0, 0.03, 0.01, 0};
  for (int i = 0; i < 10; ++i) first.step(actions, p.dt);
  second.set_state(first.state());
  for (int i = 0; i < 10; ++i) {
    first.step(actions, p.dt);
    second.step(actions, p.dt);
  }
  EXPECT_TRUE(observe(first) == observe(second));
}

// A hand that goes nowhere in particular breaks its own thread only, says so, and can begin anew.
TEST_F(DeviceThreads, WhatCannotBeSolvedIsSaid) {
  const ThreadsProblem p = bow(4);
  Threads threads(*device_, p, 2);
  threads.step(std::vector<Real>{std::nan(""), 0, 0, 0.05, 0, 0}, p.dt);
  threads.step(std::vector<Real>{0, 0, 0, 0.05, 0, 0}, p.dt);
  const auto residual = static_cast<std::size_t>(3 + p.points());
  const auto second = residual + static_cast<std::size_t>(threads.observations());
  EXPECT_TRUE(std::isnan(observe(threads)[residual]));
  EXPECT_LT(observe(threads)[second], 1e-9);
  threads.reset(std::vector<std::uint8_t>{1, 0});
  threads.step(std::vector<Real>{0.05, 0, 0, 0.05, 0, 0}, p.dt);
  EXPECT_LT(observe(threads)[residual], 1e-9);
  try {
    threads.step(std::vector<Real>{0, 0, 0}, p.dt);
    FAIL() << "three numbers for two threads";
  } catch (const DeviceError& e) {
    EXPECT_STREQ(e.what(), "a batch was given 3 numbers of actions; expected 6");
  }
}

TEST(ThreadsProblemTest, SaysWhatIsWrong) {
  ThreadsProblem p = bow(3);
  EXPECT_EQ(p.problem(), "");
  p.path.push_back(0);
  EXPECT_NE(p.problem().find("'path' has 10 numbers"), std::string::npos) << p.problem();
  p.path = {1, 2, 3, 1, 2, 3};
  EXPECT_NE(p.problem().find("points that differ"), std::string::npos) << p.problem();
  p.direction = Vec3::Zero();
  EXPECT_NE(p.problem().find("'direction' is zero"), std::string::npos) << p.problem();
}

}  // namespace
}  // namespace sutura::opencl
