#include "async_factor.h"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <thread>
#include <utility>

namespace sutura::tissue {

bool SnapshotFactor::factorise(const std::shared_ptr<const FactorPlan>& base) {
  const auto start = std::chrono::steady_clock::now();
  const auto& candidates = snapshot->candidates;
  const bool analyse = !plan || !std::ranges::equal(candidates_of(*plan), candidates);
  if (analyse) {
    plan = std::ranges::equal(candidates_of(*base), candidates)
               ? base
               : with_candidates(*base, candidates);
    factor = make_factor(plan);
    if (rough) factor->keep_rough();
  }
  ok = factor->factorise(snapshot->A);
  if (ok) compliance.begin(*factor, candidates_of(*plan), snapshot->A.nodes());
  seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return analyse;
}

namespace {

/// The only worker of one tissue.
class OwnWorker : public WorkerPool {
 public:
  OwnWorker() : thread_(deaf_thread([this] { run(); })) {}
  ~OwnWorker() override {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    wake_.notify_one();
    thread_.join();
  }

  void enqueue(std::shared_ptr<Job> job) override {
    {
      const std::lock_guard lock(mutex_);
      job_ = std::move(job);
    }
    wake_.notify_one();
  }

 private:
  /// Signals of the process go to workers of the host: its handlers do not run on ours.
  template <class Run>
  static std::thread deaf_thread(const Run& run) {
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    std::thread out(run);
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    return out;
  }

  void run() {
    std::unique_lock lock(mutex_);
    while (true) {
      wake_.wait(lock, [this] { return stop_ || job_; });
      if (stop_) return;
      const std::shared_ptr<Job> job = std::move(job_);
      lock.unlock();
      job->run();
      lock.lock();
    }
  }

  std::mutex mutex_;
  std::condition_variable wake_;
  std::shared_ptr<Job> job_;
  bool stop_ = false;
  std::thread thread_;
};

/// Where every factorisation beside a step goes through. A process that ends waits there for those
/// that are under way: the libraries that they work with are about to clean up.
class Gate {
 public:
  static Gate& only() {
    static Gate* const gate = new Gate;  // never destroyed: workers may still come
    return *gate;
  }
  bool enter() {
    const std::lock_guard lock(mutex_);
    if (closed_) return false;
    if (process_ != ::getpid()) inside_ = 0;  // workers do not come along when a process forks
    process_ = ::getpid();
    ++inside_;
    return true;
  }
  void leave() {
    const std::lock_guard lock(mutex_);
    if (--inside_ == 0) empty_.notify_all();
  }

 private:
  Gate() {
    std::atexit([] { only().close(); });
  }
  void close() {
    std::unique_lock lock(mutex_);
    closed_ = true;
    empty_.wait(lock, [this] { return inside_ == 0 || process_ != ::getpid(); });
  }

  std::mutex mutex_;
  std::condition_variable empty_;
  int inside_ = 0;
  pid_t process_ = ::getpid();
  bool closed_ = false;
};

}  // namespace

/// Where a job lies until a worker takes it, and then its answer. A pool may come to it late: it
/// outlives the tissue then, and has nothing to do.
class FactorWorker::Desk : public Job {
 public:
  Desk(std::shared_ptr<const FactorPlan> plan, Hook hook)
      : plan_(std::move(plan)), hook_(std::move(hook)) {}

  void put(std::unique_ptr<SnapshotFactor> job) {
    const std::lock_guard lock(mutex_);
    job_ = std::move(job);
  }

  void run() noexcept override {
    std::unique_lock lock(mutex_);
    if (!job_ || !Gate::only().enter()) return;
    std::unique_ptr<SnapshotFactor> job = std::move(job_);
    at_work_ = ::getpid();
    lock.unlock();
    const bool answer = !hook_ || hook_(job->snapshot->step);
    try {
      if (answer) job->factorise(plan_);
    } catch (...) {  // no memory; here nobody else could catch it
      job->ok = false;
      job->plan.reset();
    }
    lock.lock();
    if (answer) answer_ = std::move(job);
    at_work_ = 0;
    done_.notify_all();
    lock.unlock();
    Gate::only().leave();
  }

  std::unique_ptr<SnapshotFactor> take(std::chrono::duration<double> patience) {
    std::unique_lock lock(mutex_);
    if (!answer_ && patience.count() > 0)
      done_.wait_for(lock, patience, [this] { return answer_ || is_lost(); });
    return std::move(answer_);
  }

  /// Nobody is at work on it any more, and nobody begins.
  void clear() {
    std::unique_lock lock(mutex_);
    job_.reset();
    done_.wait(lock, [this] { return at_work_ == 0 || is_lost(); });
    answer_.reset();
  }

 private:
  /// The process has forked, and who was at work has stayed behind.
  bool is_lost() const { return at_work_ != 0 && at_work_ != ::getpid(); }

  std::shared_ptr<const FactorPlan> plan_;
  Hook hook_;
  std::mutex mutex_;  ///< guards the rest; held for a few instructions
  std::condition_variable done_;
  std::unique_ptr<SnapshotFactor> job_, answer_;
  pid_t at_work_ = 0;  ///< the process whose worker is at it
};

FactorWorker::FactorWorker(std::shared_ptr<const FactorPlan> plan, std::shared_ptr<WorkerPool> pool,
                           Hook hook)
    : desk_(std::make_shared<Desk>(std::move(plan), std::move(hook))),
      pool_(pool ? std::move(pool) : std::make_shared<OwnWorker>()) {}

FactorWorker::~FactorWorker() {
  desk_->clear();
}

void FactorWorker::submit(std::unique_ptr<SnapshotFactor> job) {
  assert(!busy_);
  busy_ = true;
  desk_->put(std::move(job));
  pool_->enqueue(desk_);
}

std::unique_ptr<SnapshotFactor> FactorWorker::take(std::chrono::duration<double> patience) {
  if (patience.count() > 0) desk_->run();
  std::unique_ptr<SnapshotFactor> out = desk_->take(patience);
  if (out) busy_ = false;
  return out;
}

}  // namespace sutura::tissue
