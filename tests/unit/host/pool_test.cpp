// Workers that the host lends, and processes that end or fork while these are at work.
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cfenv>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <thread>

#include "unit/host/loaded.h"

namespace sutura::host_tests {
namespace {

// Half a second of it asks for a dozen factors.
const std::string stitch = scenes + "suture/first_stitch.xml";
constexpr std::size_t steps = 50;

/// The state after some steps; `points`: also those of the first body.
std::vector<std::byte> run(const sutura_options& how, std::vector<double>* points = nullptr) {
  const sutura_simulation s = load_fixed(stitch, how);
  EXPECT_EQ(sutura_step(s, steps), SUTURA_OK) << sutura_error();
  std::vector<std::byte> out = state(s);
  sutura_body body = 0;
  sutura_geometry g{};
  g.struct_size = sizeof g;
  EXPECT_EQ(sutura_body_at(s, 0, &body), SUTURA_OK);
  EXPECT_EQ(sutura_get_geometry(body, &g), SUTURA_OK);
  if (points != nullptr) points->assign(g.points, g.points + 3 * g.point_count);
  EXPECT_EQ(sutura_destroy(s), SUTURA_OK);
  return out;
}

/// Two workers in a floating-point mode of their own. `Way`: what becomes of what is handed in.
class Pool {
 public:
  enum class Way { queued, at_once, twice, dropped };
  explicit Pool(Way way) : way_(way) {
    for (int i = 0; i < 2; ++i) workers_.emplace_back([this] { work(); });
  }
  ~Pool() {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    wake_.notify_all();
    for (std::thread& w : workers_) w.join();
  }
  sutura_options options() {
    sutura_options out = host_tests::options();
    out.enqueue = &enqueue;
    out.pool = this;
    return out;
  }
  struct Entry {
    sutura_job job;
    void* data;
  };
  std::vector<Entry> handed_in() {
    const std::lock_guard lock(mutex_);
    return handed_in_;
  }

 private:
  static void enqueue(void* pool, sutura_job job, void* data) {
    auto& self = *static_cast<Pool*>(pool);
    const std::unique_lock lock(self.mutex_);
    self.handed_in_.push_back({job, data});
    if (self.way_ == Way::at_once) job(data);
    if (self.way_ == Way::queued || self.way_ == Way::twice) self.queue_.push_back({job, data});
    if (self.way_ == Way::twice) self.queue_.push_back({job, data});
    self.wake_.notify_all();
  }
  void work() {
    std::fesetround(FE_UPWARD);
    std::unique_lock lock(mutex_);
    while (true) {
      wake_.wait(lock, [this] { return stop_ || !queue_.empty(); });
      if (stop_) return;
      const Entry next = queue_.front();
      queue_.pop_front();
      lock.unlock();
      next.job(next.data);
      lock.lock();
    }
  }

  Way way_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Entry> queue_;
  std::vector<Entry> handed_in_;
  bool stop_ = false;
  std::vector<std::thread> workers_;
};

TEST(Pool, HoweverItWorksTheBitsAreThoseOfOwnWorkers) {
  const std::vector<std::byte> expected = run(options());
  for (const Pool::Way way :
       {Pool::Way::queued, Pool::Way::at_once, Pool::Way::twice, Pool::Way::dropped}) {
    Pool pool(way);
    std::atomic<int> equal{0};
    std::vector<std::thread> hosts;
    for (int i = 0; i < 2; ++i)
      hosts.emplace_back([&] { equal += run(pool.options()) == expected ? 1 : 0; });
    for (std::thread& h : hosts) h.join();
    EXPECT_EQ(equal.load(), 2) << "way " << static_cast<int>(way);
    ASSERT_GT(pool.handed_in().size(), 0u) << "the scene does not show what this test is about";
    // The simulations are gone; late, again or with something made up, nothing happens.
    for (const Pool::Entry& e : pool.handed_in()) e.job(e.data);
    pool.handed_in()[0].job(nullptr);
    pool.handed_in()[0].job(&pool);
  }
}

TEST(Pool, NoWorkerIsStartedBesideThoseOfTheHost) {
  const auto count = [] {
    const std::filesystem::directory_iterator tasks("/proc/self/task");
    return std::distance(begin(tasks), end(tasks));
  };
  run(options());  // libraries start what they start
  Pool pool(Pool::Way::queued);
  const auto before = count();
  const sutura_options how = pool.options();
  const sutura_simulation s = load_fixed(stitch, how), t = load_fixed(stitch, how);
  EXPECT_EQ(sutura_step(s, steps), SUTURA_OK) << sutura_error();
  EXPECT_EQ(sutura_step(t, steps), SUTURA_OK) << sutura_error();
  EXPECT_EQ(count(), before);
  EXPECT_EQ(sutura_destroy(s), SUTURA_OK);
  EXPECT_EQ(sutura_destroy(t), SUTURA_OK);
}

TEST(Pool, OptionsOfAProgramThatKnowsOfNone) {
  sutura_options how = options();
  how.struct_size = offsetof(sutura_options, enqueue);
  how.enqueue = [](void*, sutura_job, void*) { ADD_FAILURE() << "behind the end of the struct"; };
  const sutura_simulation s = load(stitch, &how);
  EXPECT_EQ(sutura_step(s, steps), SUTURA_OK) << sutura_error();
  EXPECT_EQ(sutura_destroy(s), SUTURA_OK);
}

/// Begins the first factorisation on a worker and, while it is under way, does `then` in the middle
/// of the step; the others begin as well.
struct Interrupted {
  std::function<void()> then;
  static void enqueue(void* pool, sutura_job job, void* data) {
    std::atomic<bool> begun{false};
    std::thread([&begun, job, data] {
      begun = true;
      job(data);
    }).detach();
    while (!begun) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));  // it takes ten or more
    auto& self = *static_cast<Interrupted*>(pool);
    if (self.then) std::exchange(self.then, nullptr)();
  }
  sutura_options options() {
    sutura_options out = host_tests::options();
    out.enqueue = &enqueue;
    out.pool = this;
    return out;
  }
};

// It waits for the factorisation: the libraries that this needs clean up when a process ends.
TEST(Pool, AProcessMayEndWhileAFactorIsMade) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  for (int i = 0; i < 3; ++i)
    EXPECT_EXIT(
        {
          Interrupted host{[] { std::exit(0); }};
          run(host.options());
        },
        testing::ExitedWithCode(0), "^$");
}

// The child has the simulation, but not the worker: it notes that in its state and factorises in
// the step, with the same bits.
TEST(Pool, AProcessMayForkWhileAFactorIsMade) {
#ifdef SUTURA_SANITIZED
  GTEST_SKIP() << "sanitizers have workers of their own";
#endif
  std::vector<double> expected, found;
  const std::vector<std::byte> all = run(options(), &expected);
  pid_t child = -1;
  Interrupted host{[&child] { child = ::fork(); }};
  const std::vector<std::byte> all_found = run(host.options(), &found);
  if (child == 0) ::_exit(found == expected ? 0 : 1);
  EXPECT_TRUE(all_found == all);
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace sutura::host_tests
