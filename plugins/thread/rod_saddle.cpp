// What a step of a rod does where its guess is balanced, but at a saddle of the potential.
#include <cmath>

#include "rod_potential.h"
#include "rod_step.h"

namespace sutura::thread {

/// Whether the guess is no minimum of the potential, as a straight rod is not that is pushed
/// together. What constraints push is taken for held: they may hold it. Overwrites the matrix of
/// the step, which the next pass assembles anew.
bool RodStep::buckles(const Rod& rod) {
  bool compressed = false;
  for (Index e = 0; e < rod.beams() && !compressed; ++e) {
    // A straight beam that inertia alone holds sideways buckles at 2 sqrt(EI m / L) / h.
    const Real least = std::sqrt(rod.element(e).bend_1 * rod.element(e).mass) / start_.dt;
    compressed = !rod.stretches().is_rigid(e) && guess_.beams[e].tension < -least;
  }
  if (!compressed) return false;
  guess_.take_tension();
  assemble(rod, start_, guess_, Tangent::exact, matrix_);
  for (Index i = 0; i < rod.nodes(); ++i)
    for (int d = 0; guess_.force.pushes(i) && d < 6; ++d) matrix_.fix(rod.stretches().block(i), d);
  if (matrix_.factor()) return false;
  // Rounding makes a slender chain indefinite by 1e-13 of its diagonal (rod_tangent.cpp).
  for (Index i = 0; i < matrix_.blocks(); ++i) matrix_.diagonal(i).diagonal() *= 1 + 1e-10;
  return !matrix_.factor();
}

/// Along a direction of negative curvature, as far as the potential falls.
bool RodStep::leave_saddle(Rod& rod) {
  if (!buckles(rod)) return false;
  matrix_.negative_direction(rod.element(0).length, answer_.head(6 * matrix_.blocks()));
  rod.stretches().unpack(rod.poses(), answer_);
  const Real turn = largest_turn(rod, Configuration::current, answer_);
  if (!(turn > 0)) return false;
  const Real downhill = guess_.missing.dot(answer_) < 0 ? -1 : 1;
  answer_ *= downhill * 1e-3 / turn;  // by a milliradian first
  Real lowest = potential(rod, start_, guess_);
  for (Real part = 1; part < 1e3 * turn_limit; part *= 2) {
    guess_.motion += part * answer_;
    guess_.move(rod, start_);
    const Real now = potential(rod, start_, guess_);
    if (now < lowest) {
      lowest = now;
      continue;
    }
    guess_.motion -= part * answer_;
    guess_.move(rod, start_);
    if (part == 1) return false;
    break;
  }
  guess_.take_tension();
  return true;
}

}  // namespace sutura::thread
