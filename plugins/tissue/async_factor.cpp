#include "async_factor.h"

#include <pthread.h>
#include <signal.h>

#include <algorithm>
#include <cassert>
#include <new>
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
    number.assign(static_cast<std::size_t>(snapshot->A.nodes()), -1);
    for (std::size_t k = 0; k < candidates.size(); ++k)
      number[static_cast<std::size_t>(candidates[k])] = static_cast<Index>(k);
  }
  ok = factor->factorise(snapshot->A);
  if (ok) factor->candidate_compliance(compliance);
  seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return analyse;
}

namespace {

/// Signals of the process go to workers of the host: its handlers do not run on ours.
template <class Run>
std::thread deaf_thread(const Run& run) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread out(run);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return out;
}

}  // namespace

FactorWorker::FactorWorker(std::shared_ptr<const FactorPlan> plan, Hook hook)
    : plan_(std::move(plan)), hook_(std::move(hook)), thread_(deaf_thread([this] { run(); })) {}

FactorWorker::~FactorWorker() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void FactorWorker::submit(std::unique_ptr<SnapshotFactor> job) {
  assert(!busy_);
  busy_ = true;
  {
    const std::lock_guard lock(mutex_);
    job_ = std::move(job);
  }
  wake_.notify_one();
}

std::unique_ptr<SnapshotFactor> FactorWorker::take(std::chrono::duration<double> patience) {
  std::unique_lock lock(mutex_);
  if (!answer_ && patience.count() > 0)
    done_.wait_for(lock, patience, [this] { return answer_ != nullptr; });
  if (answer_) busy_ = false;
  return std::move(answer_);
}

void FactorWorker::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return stop_ || job_; });
    if (stop_) return;
    std::unique_ptr<SnapshotFactor> job = std::move(job_);
    lock.unlock();
    const bool answer = !hook_ || hook_(job->snapshot->step);
    try {
      if (answer) job->factorise(plan_);
    } catch (const std::bad_alloc&) {  // here nobody else could catch it
      job->ok = false;
      job->plan.reset();
    }
    lock.lock();
    if (answer) {
      answer_ = std::move(job);
      done_.notify_one();
    }
  }
}

}  // namespace sutura::tissue
