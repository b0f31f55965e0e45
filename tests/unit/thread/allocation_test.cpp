// The step allocates nothing: every malloc of the process is counted (Eigen's too).
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>

#include "rod_builder.h"
#include "suture_thread.h"

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

static std::atomic<long> allocations{0};
extern "C" void* __libc_malloc(std::size_t);
extern "C" void* malloc(std::size_t size) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(size);
}

namespace sutura::thread {
namespace {

TEST(Allocation, CounterCounts) {
  const long before = allocations;
  { const VecX v = VecX::Ones(100); EXPECT_EQ(v.sum(), 100); }
  EXPECT_GT(allocations, before);
}

TEST(Allocation, NoneInTheStep) {
  for (const bool violent : {false, true}) {
    Rod rod;
    RodLayout layout = straight_layout(0.2, 100, nylon());
    if (violent)
      for (std::size_t i = 1; i < layout.start.size(); i += 2) layout.start[i].position.z() += 2e-2;
    rod.build(layout);
    rod.clamp(0);
    const VecX none = VecX::Zero(rod.dofs());
    const long before = allocations;
    Index passes = 0;
    for (int i = 0; i < 10; ++i) {
      if (!rod.free_motion(0.01, Vec3(0, 0, -9.81))) std::abort();
      rod.correct(0.01, none);
      passes = std::max(passes, rod.passes());
    }
    EXPECT_EQ(allocations, before) << (violent ? "violent" : "calm");
    EXPECT_EQ(passes > 9, violent);  // the guarded descent was there
  }
}

TEST(Allocation, NoneInAQuietStepOfASampledThread) {
  Diagnostics diagnostics;
  SutureThread thread;
  thread.needle_arc_length = 0;
  thread.thread_beams = 20;
  thread.sampling_angle = 0.2;
  thread.clamp = SutureThread::Clamp::start;
  sutura::Setup setup{diagnostics, {}, {}, 0.01, Vec3::Zero(), 1};
  thread.initialise(setup);
  ASSERT_TRUE(diagnostics.ok());
  const StepContext context{.dt = 0.01};
  const auto step = [&](const VecX& force) {
    thread.free_motion(context);
    thread.correct(context, force);
  };
  // The U turn it is laid out with makes it sample (and so allocate) first.
  const Index laid_out = thread.dofs();
  bool sampled = false;
  for (int i = 0; i < 1000; ++i) {
    step(VecX::Zero(thread.dofs()));
    sampled = sampled || thread.dofs() != laid_out;
  }
  ASSERT_TRUE(sampled);
  const Index dofs = thread.dofs();
  const VecX none = VecX::Zero(dofs);
  const long before = allocations;
  for (int i = 0; i < 100; ++i) step(none);
  EXPECT_EQ(allocations, before);
  EXPECT_EQ(thread.dofs(), dofs);  // quiet: no event among the hundred
}

}  // namespace
}  // namespace sutura::thread

#endif
