#include "sampling.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "cubic.h"

namespace sutura::thread {

Real turning_angle(const Rod& rod, Index beam, Configuration configuration) {
  const auto& p = rod.poses(configuration);
  const Cubic c(p[beam], p[beam + 1], rod.element(beam).length);
  constexpr int parts = 4;
  Real sum = 0;
  Vec3 before = p[beam].rotation * Vec3::UnitX();
  for (int i = 1; i <= parts; ++i) {
    const Vec3 t = c.slope(static_cast<Real>(i) / parts).normalized();
    sum += std::atan2(before.cross(t).norm(), before.dot(t));
    before = t;
  }
  return sum;
}

namespace {

/// Does one beam in place of beams e and e + 1 have their elastic energy, to half a percent? At
/// rest it does; a short wave that runs along the thread it would swallow. What beams bent by a
/// tenth of `angle` have does not matter.
bool keeps_energy(const Rod& rod, Index e, Real angle) {
  const auto& rest = rod.poses(Configuration::rest);
  const auto& now = rod.poses();
  ElementState state;
  Real halves = 0;
  for (const Index half : {e, e + 1}) {
    rod.element_state(half, state);
    halves += elastic_energy(rod.element(half), state);
  }
  const Real length = rod.element(e).length + rod.element(e + 1).length;
  const ElementRest whole(rest[e], rest[e + 2], length, rod.section(e));
  evaluate(whole, now[e], now[e + 2], rod.twist()[e] + rod.twist()[e + 1], state);
  const Real bend = angle / 10;
  const Real least = rod.section(e).bending_stiffness() / length * bend * bend / 2;
  return std::abs(elastic_energy(whole, state) - halves) <= 0.005 * (halves + least);
}

/// The bend of a beam at rest. Its sections turn there by torsion as well, and half a radian of
/// that counts as a bend of `angle`: from half a turn on nodes do not tell which way.
Real turn_at_rest(const Rod& rod, Index e, Real angle) {
  constexpr Real most = 0.5;
  const auto& p = rod.poses(Configuration::rest);
  const Real sections = p[e].rotation.angularDistance(p[e + 1].rotation);
  if (sections < 1e-9) return 0;  // straight
  return std::max(turning_angle(rod, e, Configuration::rest), angle * sections / most);
}

}  // namespace

void SamplingWork::reserve(std::size_t beams) {
  nodes.reserve(2 * beams + 1);  // at most every beam is split
  angle.reserve(beams);
  split.reserve(beams);
}

std::vector<Real> sample(const Rod& rod, const SamplingRules& rules, bool& changed) {
  SamplingWork work;
  changed = sample(rod, rules, work);
  return std::move(work.nodes);
}

bool sample(const Rod& rod, const SamplingRules& rules, SamplingWork& work) {
  const std::vector<Real>& s = rod.abscissa();
  const Index n = rod.beams();
  std::vector<Real>& angle = work.angle;
  std::vector<char>& split = work.split;
  angle.assign(static_cast<std::size_t>(n), 0);
  split.assign(static_cast<std::size_t>(n), 0);
  const auto length = [&](Index e) { return s[e + 1] - s[e]; };
  const auto fixed = [&](Index e) {
    return s[e] < rules.from - 1e-9 || rod.stretches().is_rigid(e) || rod.is_cut(e);
  };
  for (Index e = 0; e < n; ++e) {
    if (fixed(e)) continue;
    angle[e] = std::max(turning_angle(rod, e), turn_at_rest(rod, e, rules.angle));
    const bool bent = angle[e] > rules.angle;
    split[e] = (bent && length(e) >= 2 * rules.shortest) || length(e) > rules.longest * (1 + 1e-9);
  }
  // Grading: a beam more than twice as long as what its neighbour becomes is split too; spreads
  // both ways.
  const auto after = [&](Index e) { return length(e) / (split[e] ? 2 : 1); };
  for (bool more = true; more;) {
    more = false;
    for (Index e = 0; e < n; ++e) {
      if (split[e] || fixed(e)) continue;
      const Real neighbour =
          std::min(e > 0 ? after(e - 1) : length(e), e + 1 < n ? after(e + 1) : length(e));
      if (length(e) > 2 * neighbour * (1 + 1e-9)) split[e] = 1, more = true;
    }
  }
  bool changed = false;
  std::vector<Real>& nodes = work.nodes;
  nodes.assign(1, s[0]);
  const auto is_forced = [&](Real a) {
    return std::any_of(rules.forced.begin(), rules.forced.end(),
                       [a](Real f) { return std::abs(f - a) < 1e-9; });
  };
  Index last_merged = -2;  // second beam of the last merged pair
  for (Index e = 0; e < n; ++e) {
    // May node e + 1 go? Its two beams become one; neighbours must stand the longer one.
    bool merge = e + 1 < n && !fixed(e) && !fixed(e + 1) && e != last_merged && !split[e] &&
                 !split[e + 1] && !is_forced(s[e + 1]);
    if (merge) {
      const Real L = length(e) + length(e + 1), theta = angle[e] + angle[e + 1];
      const Real left =
          e > 0 ? (last_merged == e - 1 ? length(e - 1) + length(e - 2) : after(e - 1)) : L;
      const Real right = e + 2 < n ? after(e + 2) : L;
      merge = theta < rules.angle / 2 && L <= rules.longest * (1 + 1e-9) &&
              L <= 2 * left * (1 + 1e-9) && L <= 2 * right * (1 + 1e-9) &&
              // halves of a former split find together again, and not shifted by one
              std::abs(length(e) - length(e + 1)) < 0.26 * L && keeps_energy(rod, e, rules.angle);
    }
    if (split[e]) nodes.push_back((s[e] + s[e + 1]) / 2), changed = true;
    if (merge) {
      nodes.push_back(s[e + 2]);
      changed = true;
      last_merged = ++e;
    } else {
      nodes.push_back(s[e + 1]);
    }
  }
  return changed;
}

}  // namespace sutura::thread
