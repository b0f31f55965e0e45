// ThreadProbe: what one section of a needle or thread does.
#pragma once

#include "sutura/describe.h"
#include "sutura/probe.h"
#include "suture_thread.h"

namespace sutura::thread {

class ThreadProbe : public Component, public PointProbe {
 public:
  static void describe(Describe<ThreadProbe>& d);
  void initialise(Setup& setup) override;
  Vec3 position() const override { return thread_->point(at_, Configuration::current); }

 private:
  Link<SutureThread> thread_;
  Real at_ = 0;
};

}  // namespace sutura::thread
