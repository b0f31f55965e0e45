#include "region_thresholds.h"

#include <algorithm>
#include <sstream>

namespace sutura::suturing {

void RegionThresholds::find_regions(const Component& who, Setup& setup, const SolidBody& tissue) {
  std::size_t count = 0;
  std::istringstream names(text_);
  for (std::string name; names >> name; ++count) {
    std::string error;
    const std::optional<int> tag = tissue.find_region(name, error);
    if (!tag)
      setup.error(who, "regions: " + error);
    else if (has_threshold(*tag))
      setup.error(who, "regions: '" + name + "' is named twice");
    else
      regions_.push_back(*tag);
  }
  if (count != thresholds_.size())
    setup.error(who, "'regions' names " + std::to_string(count) +
                         " regions, 'region_thresholds' has " + std::to_string(thresholds_.size()) +
                         " numbers; expected one value per region");
}

bool RegionThresholds::has_threshold(int region) const {
  return std::find(regions_.begin(), regions_.end(), region) != regions_.end();
}

Real RegionThresholds::threshold_of(int region, Real otherwise) const {
  const auto found = std::find(regions_.begin(), regions_.end(), region);
  return found == regions_.end() ? otherwise
                                 : thresholds_[static_cast<std::size_t>(found - regions_.begin())];
}

}  // namespace sutura::suturing
