// The pool of workers that a host lends through the C API.
#pragma once

#include "host/session.h"
#include "sutura/worker_pool.h"

namespace sutura::host {

/// Of one session, which must live longer. The host is given numbers and no pointers, so that it
/// may come late, twice, or with something made up.
class HostPool : public WorkerPool {
 public:
  HostPool(const Session& session, sutura_enqueue enqueue, void* pool)
      : session_(session), enqueue_(enqueue), pool_(pool) {}
  void enqueue(std::shared_ptr<Job> job) override;

 private:
  const Session& session_;
  sutura_enqueue enqueue_;
  void* pool_;
};

}  // namespace sutura::host
