// A force per region of a tissue, written as two lists: regions="dermis fat"
// region_thresholds="0.4 0.2 N".
#pragma once

#include <string>
#include <vector>

#include "sutura/body.h"
#include "sutura/describe.h"

namespace sutura::suturing {

/// Base of a component that has these two attributes.
class RegionThresholds {
 protected:
  template <class C>
  static void describe_regions(Describe<C>& d, Range range, const std::string& more = "") {
    d.attribute("regions", static_cast<std::string C::*>(&RegionThresholds::text_),
                "Regions of the tissue, by name or number as in Layer, blank separated, with a "
                "threshold of their own" +
                    more + ".");
    d.attribute("region_thresholds",
                static_cast<std::vector<Real> C::*>(&RegionThresholds::thresholds_), "N", range,
                "One threshold per region in `regions`.");
  }
  /// Finds the regions. Complains of names the tissue does not have, and if there is not one
  /// threshold for each.
  void find_regions(const Component& who, Setup& setup, const SolidBody& tissue);
  bool has_threshold(int region) const;
  /// N; `otherwise` where the region has none of its own.
  Real threshold_of(int region, Real otherwise) const;

 private:
  std::string text_;
  std::vector<Real> thresholds_;  ///< N
  std::vector<int> regions_;      ///< tags, of the names in the text
};

}  // namespace sutura::suturing
