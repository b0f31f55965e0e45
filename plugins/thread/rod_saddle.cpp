// What a step of a rod does where its guess is balanced, but at a saddle of the potential.
#include <algorithm>
#include <cmath>
#include <utility>

#include "rod_potential.h"
#include "rod_step.h"

namespace sutura::thread {

/// By more than inertia alone can hold sideways: a straight beam then buckles at 2 sqrt(EI m/L)/h.
bool RodStep::is_compressed(const Rod& rod) const {
  for (Index e = 0; e < rod.beams(); ++e) {
    const Real least = std::sqrt(rod.element(e).bend_1 * rod.element(e).mass) / start_.dt;
    if (!rod.stretches().is_rigid(e) && guess_.beams[e].tension < -least) return true;
  }
  return false;
}

/// The matrix of the step at the guess, with what constraints push held where it is: they may hold
/// it. The next pass assembles it anew.
void RodStep::assemble_unpushed(const Rod& rod, Real convex) {
  assemble(rod, start_, guess_, convex, matrix_);
  for (Index i = 0; i < rod.nodes(); ++i)
    for (int d = 0; guess_.force.pushes(i) && d < 6; ++d) matrix_.fix(rod.stretches().block(i), d);
}

/// Whether the guess is no minimum of the potential, as a straight rod is not that is pushed
/// together.
bool RodStep::buckles(const Rod& rod) {
  guess_.take_tension();
  assemble_unpushed(rod, 0);
  if (matrix_.factor()) return false;
  // Rounding makes a slender chain indefinite by 1e-13 of its diagonal (rod_tangent.cpp).
  for (Index i = 0; i < matrix_.blocks(); ++i) matrix_.diagonal(i).diagonal() *= 1 + 1e-10;
  return !matrix_.factor();
}

/// How the rod buckles, to `answer_`. The direction at the pivot that failed is that of the
/// shortest piece from the start of the rod that buckles while all beyond it is held. That piece
/// hardly does: the potential falls for a fraction of a milliradian only. The mode to take is the
/// one in which compression most outweighs what resists it, inertia, bending and stretch: that of
/// the largest eigenvalue of C^-1 (C - A), C the convex part of A. A few powers are near enough.
/// Returns that eigenvalue: above 1 the rod buckles.
Real RodStep::find_buckling(const Rod& rod) {
  auto mode = answer_.head(6 * matrix_.blocks());
  auto product = change_.head(6 * matrix_.blocks());
  matrix_.negative_direction(rod.element(0).length, mode);
  // The second mode of a column has a third of the first one's eigenvalue.
  constexpr int powers = 10;
  Real eigenvalue = 0;
  for (int i = 0; i < powers; ++i) {
    assemble_unpushed(rod, 0);
    matrix_.multiply(mode, product);
    assemble_unpushed(rod, 1);
    if (!factor(matrix_)) break;
    matrix_.solve(Eigen::Ref<VecX>(product));
    mode -= product;
    eigenvalue = mode.lpNorm<Eigen::Infinity>();
    mode /= eigenvalue;
  }
  rod.stretches().unpack(rod.poses(), answer_);
  return eigenvalue;
}

/// Along a direction in which the rod buckles, as far as the potential falls.
bool RodStep::buckle(Rod& rod) {
  // The matrix leaves out what the mass changes by as the tangents turn: where it is negative by a
  // hundredth only, the potential may well be at its minimum.
  stuck_ = find_buckling(rod) > 1.01;
  const Real turn = largest_turn(rod, Configuration::current, answer_);
  if (!(turn > 0)) return false;
  const Real downhill = guess_.missing.dot(answer_) < 0 ? -1 : 1;
  answer_ *= downhill / turn;  // by a radian
  guess_.force.hold(rod);
  way_.aim(rod, guess_, answer_);
  change_ = guess_.motion;
  Real lowest = potential(rod, start_, guess_);
  const auto falls = [&](Real part) {
    way_.go(rod, start_, guess_, part);
    const Real before = std::exchange(lowest, std::min(lowest, potential(rod, start_, guess_)));
    return lowest < before;
  };
  // By a milliradian first, or by less where that leads up again; below a microradian what the
  // potential changes by drowns in rounding.
  Real part = 0;
  for (Real first = 1e-3; part == 0 && first > 1e-6; first /= 4)
    part = falls(first) ? first : falls(-first) ? -first : 0;
  if (part == 0) {
    move_to(rod, change_);
    return false;
  }
  stuck_ = false;
  while (std::abs(2 * part) < turn_limit && falls(2 * part)) part *= 2;
  way_.go(rod, start_, guess_, part);
  return true;
}

/// On to where the matrix is positive definite, by as much of its convex part as that takes.
void RodStep::descend(Rod& rod) {
  constexpr Real least = 1e-4;
  constexpr int most = 30;
  Real ratio = 0;  // of the convex part to the exact matrix
  for (int pass = 0; pass < most; ++pass) {
    guess_.take_tension();
    assemble_unpushed(rod, 0);
    if (matrix_.factor()) return;
    for (;;) {
      ratio = std::max(4 * ratio, least);
      assemble_unpushed(rod, ratio / (1 + ratio));
      if (matrix_.factor()) break;
      if (ratio > 1e6) return;
    }
    change_ = guess_.missing + start_.dt * guess_.force.at;
    for (Index i = 0; i < rod.nodes(); ++i)
      if (guess_.force.pushes(i)) change_.segment<6>(6 * i).setZero();
    answer(rod, change_);
    correct(rod);
    ratio /= 16;
  }
}

bool RodStep::leave_saddle(Rod& rod) {
  if (!is_compressed(rod) || !buckles(rod) || !buckle(rod)) return false;
  descend(rod);
  guess_.take_tension();
  return true;
}

}  // namespace sutura::thread
