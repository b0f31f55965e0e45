#include "better_guess.h"

#include <algorithm>

namespace sutura {

BetterGuess::BetterGuess(const Bodies& bodies) : bodies_(bodies) {
  for (Pass& p : passes_) {
    for (const auto& b : bodies_) p.from.push_back(VecX::Zero(b.body->dofs()));
    p.to = p.from;
    p.rests.resize(bodies_.size());
  }
  guess_ = passes_[0].to;
}

void BetterGuess::forget() {
  known_ = 0;
  slow_ = false;
}

void BetterGuess::begin_pass(const std::vector<char>& rests) {
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

bool BetterGuess::move_on(const StepContext& context) {
  Pass& newest = passes_[0];
  bool whole = true;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (newest.rests[i]) continue;
    bodies_[i].body->motion(newest.to[i]);
    whole = whole && !bodies_[i].body->went_part_way();
  }
  if (!whole) forget();  // its change is not what the pass asks for
  if (known_ < 2) return false;

  // Changes f of the passes; smallest |f0 + sum of c_j (f_j - f0)|.
  using Square = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, 0, memory, memory>;
  const auto n = static_cast<Index>(known_);
  Square f(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = i; j < n; ++j)
      f(i, j) = f(j, i) =
          product(passes_[static_cast<std::size_t>(i)], passes_[static_cast<std::size_t>(j)]);
  constexpr Real well = 0.3;  // a pass that contracts by that needs no help
  slow_ = slow_ || !(f(0, 0) < well * well * f(1, 1));
  if (!slow_) return false;
  Square a(n - 1, n - 1);
  Eigen::Matrix<Real, Eigen::Dynamic, 1, 0, memory, 1> c(n - 1);
  for (Index i = 1; i < n; ++i) {
    for (Index j = 1; j < n; ++j) a(i - 1, j - 1) = f(i, j) - f(i, 0) - f(0, j) + f(0, 0);
    c[i - 1] = f(0, 0) - f(i, 0);
  }
  a.diagonal() *= 1 + 1e-10;  // passes that say the same
  c = a.ldlt().solve(c);
  if (!c.allFinite()) return false;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (newest.rests[i]) continue;
    guess_[i] = newest.to[i];
    for (Index j = 1; j < n; ++j)
      guess_[i] += c[j - 1] * (passes_[static_cast<std::size_t>(j)].to[i] - newest.to[i]);
    bodies_[i].body->move_to(context, guess_[i]);
  }
  return true;
}

}  // namespace sutura
