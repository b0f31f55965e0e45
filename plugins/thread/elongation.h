// Elongation: a thread that must not grow longer than its limit. Unilateral rows on the arc length
// of short intervals of beams: inactive while the thread is slack, however bent.
#pragma once

#include "sutura/constraints.h"
#include "suture_thread.h"

namespace sutura::thread {

class Elongation : public Component, public ConstraintSource {
 public:
  Real limit = 1e-3;
  Index interval = 1;
  Link<SutureThread> thread;
  static void describe(Describe<Elongation>& d);

  void initialise(Setup& setup) override { source_id_ = setup.source_id; }
  void ready(Setup& setup) override;
  void archive(Archive& archive) override;
  void build(const StepContext& context, ConstraintBuilder& builder) override;
  void commit(const StepContext& context, const SolvedBlocks& solved) override;
  std::string fault() const override;

  Real largest_force() const { return largest_force_; }
  Index active() const { return active_; }

 private:
  /// Beams first .. last - 1, none of them cut. The next one begins at `last` or after it; none
  /// does where that is not before the end.
  struct Interval {
    Index first, last;
  };
  Interval interval_from(Index beam) const;
  Real largest_strain() const;

  Index source_id_ = 0;
  std::vector<BlockId> blocks_;
  Real largest_force_ = 0;
  Index active_ = 0;
  Real strain_ = 0;  ///< largest of a beam, at the end of the last step
};

}  // namespace sutura::thread
