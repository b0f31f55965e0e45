// A value per region of a tissue, written as two lists: regions="1 2" and region_...="0.4 0.2 N".
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "sutura/component.h"

namespace sutura {

inline void check_region_values(const Component& who, Setup& setup,
                                const std::vector<Real>& regions, const std::vector<Real>& values,
                                const std::string& attribute) {
  if (regions.size() != values.size()) {
    setup.error(who, "'regions' has " + std::to_string(regions.size()) + " entries, '" + attribute +
                         "' has " + std::to_string(values.size()) +
                         "; expected one value per region");
  }
  for (const Real r : regions) {
    if (r != std::floor(r)) setup.error(who, "'regions' must be whole numbers (tags of the mesh)");
  }
}

inline Real region_value(int region, const std::vector<Real>& regions,
                         const std::vector<Real>& values, Real otherwise) {
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (static_cast<int>(regions[i]) == region) return values[i];
  }
  return otherwise;
}

}  // namespace sutura
