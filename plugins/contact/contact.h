// Component Contact: two partners do not pass through each other, and rub.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "contact_memory.h"
#include "rigid_tool.h"
#include "sutura/describe.h"
#include "sutura/geometry/curve_segments.h"

namespace sutura::contact {

class Contact : public Component, public ConstraintSource {
 public:
  static constexpr const char* interface_name = "Contact";
  static void describe(Describe<Contact>& d);
  void initialise(Setup& setup) override;
  void ready(Setup& setup) override;
  void archive(Archive& archive) override;
  void detect(const StepContext& context) override;
  void build(const StepContext& context, ConstraintBuilder& builder) override;
  void commit(const StepContext& context, const SolvedBlocks& solved) override;
  void keep_guess() override { pair_->keep_guess(); }
  Real free_way() const override { return pair_->free_way(); }
  bool knows_way() const override { return pair_->knows_way(); }
  std::string fault() const override;

  /// Of a thread with itself; null otherwise.
  SegmentedCurve* own_curve() const;
  /// At the end of the last step.
  const std::vector<Touch>& touches() const { return touches_; }

 private:
  /// Touches of the pass before that carried force are touches of this one.
  void keep_what_carries(const ConstraintBuilder& builder);
  void drop_beside_nearer();
  void stiffen(const StepContext& context, const Touch& touch, ConstraintBuilder& builder);
  std::unique_ptr<Pair> make_pair(Setup& setup) const;

  Link<Body> first_, second_;
  Link<RigidTool> tool_;
  bool is_sticky() const { return static_friction_ > friction_; }
  /// Places of a thread that were touched stay touches. Not where each gives way on its own: the
  /// more there are, the stiffer they would be together.
  bool keeps_places() const {
    return compliance_ == 0 || dynamic_cast<const CurveBody*>(first_.get()) == nullptr;
  }
  bool has_friction() const { return std::max(friction_, static_friction_) > 0; }

  Real friction_ = 0.2, static_friction_ = 0;
  Real compliance_ = 0;

  Index source_id_ = 0;
  std::unique_ptr<Pair> pair_;
  ContactMemory memory_;
  std::vector<Touch> touches_;
  std::vector<Touch> nearest_;  ///< memory of `drop_beside_nearer`
  std::vector<BlockId> blocks_;
  Vec3 force_ = Vec3::Zero();  ///< on the first
  Index closed_ = 0;
  Real largest_force_ = 0, normal_force_ = 0;
  bool went_through_ = false;
  bool turns_too_far_ = false;
  Real unseen_overlap_ = 0;  ///< m
  Real left_overlap_ = 0;    ///< that the step did not have to take back (m)
};

}  // namespace sutura::contact
