// Component Cutting: what the tip needs to lengthen its channel (paper, section 4.3).
#pragma once

#include "region_thresholds.h"
#include "suture_path.h"

namespace sutura::suturing {

class Cutting : public Component, public ConstraintSource, private RegionThresholds {
  friend class RegionThresholds;  // describes its own attributes

 public:
  static constexpr const char* interface_name = "Cutting";
  static void describe(Describe<Cutting>& d);
  void initialise(Setup& setup) override;
  void archive(Archive& archive) override;
  void build(const StepContext& context, ConstraintBuilder& builder) override;
  void commit(const StepContext& context, const SolvedBlocks& solved) override;

  /// Force to cut on at a point of the tissue (N).
  Real threshold(const EmbeddedPoint& at) const;

 private:
  Link<SuturePath> path_;
  Real threshold_ = 0.2;
  Index source_id_ = 0;
  BlockId block_;
  Real force_ = 0;
};

}  // namespace sutura::suturing
