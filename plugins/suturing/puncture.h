// Component Puncture: the tip presses on a tissue until the force threshold lets it through (paper, section 4.2).
#pragma once

#include <vector>

#include "cutting.h"
#include "suture_path.h"

namespace sutura {

class Puncture : public Component, public ConstraintSource {
 public:
  static constexpr const char* interface_name = "Puncture";
  static void describe(Describe<Puncture>& d);
  void initialise(Setup& setup) override;
  void detect(const StepContext& context) override;
  void build(const StepContext& context, ConstraintBuilder& builder) override;
  void commit(const StepContext& context, const SolvedBlocks& solved) override;

 private:
  enum class Side { none, outside, inside };
  void find_entry();
  void find_exit();

  Link<SuturePath> path_;
  Link<Cutting> cutting_;
  Real threshold_ = 0.5;
  Real exit_threshold_ = 0.5;
  std::vector<Real> regions_;
  std::vector<Real> region_thresholds_;
  Real friction_ = 0.2;
  Index source_id_ = 0;

  Side side_ = Side::none;
  SurfacePoint touched_;
  BlockId block_;
  Index count_ = 0;       ///< punctures so far
  Real force_ = 0;        ///< along the normal (N)
  Real peak_force_ = 0;   ///< largest so far (N)
};

}  // namespace sutura
