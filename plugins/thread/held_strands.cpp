#include "held_strands.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sutura/archive.h"

namespace sutura::thread {
namespace {

constexpr Real open = -1;
constexpr Real at_rest = 1e-3;  // of the thinnest radius: a step that costs no more
constexpr Real taut = 1e-4;     // strain

}  // namespace

void HeldStrands::begin(const Rod& rod) {
  in_flight_ = 0;
  known_to_.assign(rod.springs().size(), open);
}

void HeldStrands::end_step(const Rod& rod, Real time_error) {
  const std::vector<NodeSpring>& springs = rod.springs();
  for (std::size_t k = 0; k < springs.size(); ++k) {
    if (!springs[k].active)
      known_to_[k] = open;
    else if (known_to_[k] == open)
      known_to_[k] = in_flight_;
  }
  const Real radius = rod.section(rod.beams() - 1).radius;
  in_flight_ = time_error > at_rest * radius ? std::max(in_flight_, time_error) : 0;
}

/// Where the thread is held there (m). What is clamped has never been in flight.
Real HeldStrands::known_to(const Rod& rod, Index node) const {
  Real most = 0;
  for (std::size_t k = 0; k < known_to_.size(); ++k)
    if (rod.springs()[k].node == node) most = std::max(most, known_to_[k]);
  return most;
}

std::string HeldStrands::doubt(const Rod& rod, const RodGuess& guess) const {
  const std::vector<Real>& s = rod.abscissa();
  Index from = -1;  // where the strand is held that ends at node i
  Real stretch = 0;
  for (Index i = 0; i < rod.nodes(); ++i) {
    const Index e = i - 1;
    if (i > 0 && rod.is_cut(e)) from = -1;
    if (i > 0) stretch += guess.beams[e].strain * rod.element(e).length;
    if (!rod.is_held(i)) {
      // Round what pushes it, a strand is not straight where it is taut.
      if (guess.force.pushes(i)) from = -1;
      continue;
    }
    const Real known = from < 0 ? 0 : std::max(known_to(rod, from), known_to(rod, i));
    const Real by = std::abs(stretch);
    if (from >= 0 && by > taut * (s[i] - s[from]) && by < known) {
      char text[240];
      std::snprintf(text, sizeof text,
                    "between the holds at %.1f and %.1f mm it is %s by %.2g mm, but where it was "
                    "taken is known to %.2g mm only (the time error since it was at rest): with "
                    "another step it may be slack",
                    1e3 * s[from], 1e3 * s[i], stretch > 0 ? "stretched" : "pressed together",
                    1e3 * by, 1e3 * known);
      return text;
    }
    from = i;
    stretch = 0;
  }
  return {};
}

void HeldStrands::archive(Archive& a, const Rod& rod) {
  a("in_flight", in_flight_);
  a("known_to", known_to_);
  if (known_to_.size() != rod.springs().size()) a.fail("the holds of another thread");
}

}  // namespace sutura::thread
