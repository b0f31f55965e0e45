#include "host/host_pool.h"

#include <map>
#include <mutex>

#include "base/floating_point.h"

namespace sutura::host {
namespace {

/// What hosts have been given and may still do, by number.
class JobTable {
 public:
  std::uintptr_t number_of(const std::shared_ptr<Job>& job) {
    const std::lock_guard lock(mutex_);
    std::erase_if(all_, [](const auto& entry) { return entry.second.expired(); });
    for (const auto& [number, known] : all_)
      if (known.lock() == job) return number;
    all_.emplace(next_, job);
    return next_++;
  }
  std::shared_ptr<Job> find(std::uintptr_t number) {
    const std::lock_guard lock(mutex_);
    const auto found = all_.find(number);
    return found == all_.end() ? nullptr : found->second.lock();
  }

 private:
  std::mutex mutex_;
  std::map<std::uintptr_t, std::weak_ptr<Job>> all_;
  std::uintptr_t next_ = 1;
};

/// Never destroyed: a worker of the host may still call while the process ends.
JobTable& table() {
  static JobTable* const only = new JobTable;
  return *only;
}

void run(void* number) {
  const FloatingPoint mode;
  if (const auto job = table().find(reinterpret_cast<std::uintptr_t>(number))) job->run();
}

}  // namespace

void HostPool::enqueue(std::shared_ptr<Job> job) {
  void* const number = reinterpret_cast<void*>(table().number_of(job));
  session_.in_mode_of_host([&] { enqueue_(pool_, run, number); });
}

}  // namespace sutura::host
