#include "sutura/schedule.h"

#include <algorithm>

#include "sutura/units.h"

namespace sutura {

std::string Schedule::check(const std::vector<Real>& times, const std::vector<Real>& values) {
  if (times.size() != values.size())
    return "'times' has " + std::to_string(times.size()) + " numbers and 'factors' " +
           std::to_string(values.size()) + "; expected a factor for each time";
  for (std::size_t i = 1; i < times.size(); ++i)
    if (!(times[i] > times[i - 1]))
      return "'times' goes from " + format_real(times[i - 1]) + " s to " + format_real(times[i]) +
             " s; times must increase";
  return {};
}

Real Schedule::at(Real time) const {
  if (times_.empty()) return 1;
  const auto next = std::upper_bound(times_.begin(), times_.end(), time);
  if (next == times_.begin()) return values_.front();
  if (next == times_.end()) return values_.back();
  const auto i = static_cast<std::size_t>(next - times_.begin());
  const Real u = (time - times_[i - 1]) / (times_[i] - times_[i - 1]);
  return values_[i - 1] + u * (values_[i] - values_[i - 1]);
}

}  // namespace sutura
