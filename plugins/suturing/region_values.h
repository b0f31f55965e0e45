// A value per region of a tissue, written as two lists: regions="dermis fat" region_...="0.4 0.2
// N".
#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "sutura/body.h"
#include "sutura/component.h"

namespace sutura {

/// The tags of the regions that `text` names. Complains of names the tissue does not have, and if
/// there is not one of `values` for each.
inline std::vector<int> read_regions(const Component& who, Setup& setup, const SolidBody& tissue,
                                     const std::string& text, std::size_t values) {
  std::vector<int> tags;
  std::size_t count = 0;
  std::istringstream names(text);
  for (std::string name; names >> name; ++count) {
    std::string error;
    if (const std::optional<int> tag = tissue.find_region(name, error))
      tags.push_back(*tag);
    else
      setup.error(who, "regions: " + error);
  }
  if (count != values)
    setup.error(who, "'regions' names " + std::to_string(count) +
                         " regions, 'region_thresholds' has " + std::to_string(values) +
                         " numbers; expected one value per region");
  return tags;
}

inline Real region_value(int region, const std::vector<int>& regions,
                         const std::vector<Real>& values, Real otherwise) {
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (regions[i] == region) return values[i];
  }
  return otherwise;
}

}  // namespace sutura
