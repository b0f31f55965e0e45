#include "better_guess.h"

#include <algorithm>
#include <cmath>

namespace sutura {

BetterGuess::BetterGuess(const Bodies& bodies) : bodies_(bodies) {
  for (Pass& p : passes_) {
    for (const auto& b : bodies_) p.from.push_back(VecX::Zero(b.body->dofs()));
    p.to = p.from;
    p.rests.resize(bodies_.size());
  }
  guess_ = passes_[0].to;
  woken_.assign(bodies_.size(), 0);
}

void BetterGuess::forget() {
  known_ = 0;
  slow_ = false;
  std::fill(passes_[0].rests.begin(), passes_[0].rests.end(), 0);
  std::fill(woken_.begin(), woken_.end(), 0);
}

void BetterGuess::begin_pass(std::vector<char>& rests) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    woken_[i] = woken_[i] || (passes_[0].rests[i] && !rests[i]);
    rests[i] = rests[i] && !woken_[i];
  }
  if (known_ > 0 && passes_[0].rests != rests) known_ = 0;
  std::rotate(passes_.begin(), passes_.end() - 1, passes_.end());
  passes_[0].rests = rests;
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    if (!rests[i]) bodies_[i].body->motion(passes_[0].from[i]);
  known_ = std::min(known_ + 1, memory);
}

/// Of the changes that two passes made (m^2). Positions alone count: a thread's spin about its own
/// axis is large and without consequence.
Real BetterGuess::product(const Pass& a, const Pass& b) const {
  Real sum = 0;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (a.rests[i]) continue;
    const int width = bodies_[i].body->width();
    for (Index k = 0; k + 3 <= a.to[i].size(); k += width)
      sum += (a.to[i] - a.from[i]).segment<3>(k).dot((b.to[i] - b.from[i]).segment<3>(k));
  }
  return sum;
}

/// Whether what a pass changes grows along the way from one guess to the other. A pass goes
/// downhill by a positive definite matrix: between the two the potential then curves down.
bool BetterGuess::curve_down(const Pass& a, const Pass& b) const {
  Real sum = 0;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const int width = bodies_[i].body->width();
    if (a.rests[i] || width != 6) continue;
    for (Index k = 0; k + 3 <= a.to[i].size(); k += width) {
      const Vec3 way = (a.from[i] - b.from[i]).segment<3>(k);
      sum += way.dot((a.to[i] - b.to[i]).segment<3>(k) - way);
    }
  }
  return sum > 0;
}

bool BetterGuess::go_ahead(const StepContext& context) {
  const Pass &newest = passes_[0], &last = passes_[1];
  constexpr Real aligned = 0.8;  // cosine
  const Real both = product(newest, newest) * product(last, last);
  if (!(product(newest, last) > aligned * std::sqrt(both))) return false;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (newest.rests[i]) continue;
    guess_[i] = newest.to[i] + (newest.to[i] - newest.from[i]);
    bodies_[i].body->move_to(context, guess_[i]);
  }
  return true;
}

bool BetterGuess::move_on(const StepContext& context) {
  Pass& newest = passes_[0];
  bool whole = true;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (newest.rests[i]) continue;
    bodies_[i].body->motion(newest.to[i]);
    whole = whole && !bodies_[i].body->went_part_way();
  }
  if (!whole) {  // its change is not what the pass asks for
    known_ = 0;
    slow_ = false;
  }
  if (known_ < 2) return false;

  const Real now = product(newest, newest), before = product(passes_[1], passes_[1]);
  constexpr Real well = 0.3;  // a pass that contracts by that needs no help
  slow_ = slow_ || !(now < well * well * before);
  if (!slow_) return false;

  std::array<const Pass*, memory> other{};
  Index n = 0;
  for (std::size_t j = 1; j < known_; ++j)
    if (!curve_down(newest, passes_[j])) other[n++] = &passes_[j];
  if (n == 0) return go_ahead(context);

  // Changes f of the passes; smallest |f0 + sum of c_j (f_j - f0)|.
  Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, 0, memory, memory> a(n, n);
  Eigen::Matrix<Real, Eigen::Dynamic, 1, 0, memory, 1> c(n);
  for (Index i = 0; i < n; ++i) c[i] = now - product(*other[i], newest);
  for (Index i = 0; i < n; ++i)
    for (Index j = i; j < n; ++j)
      a(i, j) = a(j, i) = product(*other[i], *other[j]) + c[i] + c[j] - now;
  a.diagonal() *= 1 + 1e-10;  // passes that say the same
  c = a.ldlt().solve(c);
  if (!c.allFinite()) return false;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (newest.rests[i]) continue;
    guess_[i] = newest.to[i];
    for (Index j = 0; j < n; ++j) guess_[i] += c[j] * (other[j]->to[i] - newest.to[i]);
    bodies_[i].body->move_to(context, guess_[i]);
  }
  return true;
}

}  // namespace sutura
