// A thread that is laid through tissue begins in its channel, as if its needle had been there.
#include <optional>

#include "channel.h"
#include "sutura/units.h"

namespace sutura::suturing {
namespace {

// In units of the spacing of samples.
constexpr Real mouth_error = 1e-6;  // of its abscissa: nanometres, which press on nothing
constexpr Real grazing = 0.01;      // so far outside a point of the channel may be, by rounding

}  // namespace

/// The abscissa between `from` and `to`, smaller, at which the thread goes through the surface that
/// is `facing` so, or nothing.
std::optional<Real> Channel::find_mouth(Real from, Real to, const Vec3& facing) const {
  const auto crosses = [&](Real a, Real b) {
    return tissue_.crossing(thread_.point(a, now), thread_.point(b, now), now, facing).has_value();
  };
  if (!crosses(from, to)) return std::nullopt;
  while (from - to > mouth_error * spacing_) {
    const Real middle = 0.5 * (from + to);
    (crosses(from, middle) ? to : from) = middle;
  }
  return 0.5 * (from + to);
}

std::string Channel::sew() {
  samples_.clear();
  passed_ = 0;
  if (tissue_.locate(tip(), now)) return "its tip is in the tissue";
  if (tissue_.locate(thread_.point(thread_.length(), now), now)) return "its end is in the tissue";
  // The tip has gone first, so what comes first in the channel is nearest to the end of the thread.
  for (Real s = thread_.length(); s > 0;) {
    const Real next = std::max(s - search_step * spacing_, Real(0));
    const Vec3 forward = thread_.point(next, now) - thread_.point(s, now);
    const bool is_inside = tip_inside();
    const std::optional<Real> found = find_mouth(s, next, is_inside ? forward : Vec3(-forward));
    if (!found) {
      s = next;
      continue;
    }
    const Vec3 at = thread_.point(*found, now);
    const auto foot = tissue_.closest_surface(at, spacing_, now, is_inside ? forward : -forward);
    if (!foot) return "no surface was found where it goes through it";
    if (is_inside) {
      const std::string wrong = fill_bite(*found);
      if (!wrong.empty()) return wrong;
      const PathSample& entry = samples_.back();
      push(foot->at, entry.depth + entry.abscissa - *found, *found, PathSample::Kind::exit);
    } else {
      push(foot->at, 0, *found, PathSample::Kind::entry);
    }
    end_ = foot->at;
    end_depth_ = samples_.back().depth;
    // The lips of a slit lie on each other: where one is left the other is entered, and not left
    // again.
    s = *found + (is_inside ? 2 : -2) * mouth_error * spacing_;
  }
  if (tip_inside()) return "it enters the tissue and does not come out";
  return samples_.empty() ? "no part of it goes through the tissue" : "";
}

/// Samples from the entry, the last there is, to the exit at abscissa `exit`.
std::string Channel::fill_bite(Real exit) {
  const Real entry = samples_.back().abscissa;
  for (Real depth = spacing_; entry - depth - exit > too_close * spacing_; depth += spacing_) {
    const Real s = entry - depth;
    const Vec3 at = thread_.point(s, now);
    std::optional<EmbeddedPoint> inside = tissue_.locate(at, now);
    if (!inside)
      if (const auto foot = tissue_.closest_surface(at, grazing * spacing_, now)) inside = foot->at;
    if (!inside)
      return "it runs along the surface of the tissue, at abscissa " + format_real(s) + " m";
    push(*inside, depth, s, PathSample::Kind::inner);
  }
  return {};
}

}  // namespace sutura::suturing
