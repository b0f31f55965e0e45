// Which knot a closed line is: the Jones polynomial at one point, which tells a knot from its
// mirror image and a square knot from a granny. knots.h has cheaper numbers, for every step.
#pragma once

#include <map>
#include <numeric>

#include "support/knots.h"

namespace sutura::testing {

using Complex = std::complex<Real>;

/// Where the polynomials are compared: t of size 1, no root of unity, where knots could look alike.
constexpr Real jones_angle = 1;

/// From the drawing with the fewest crossings of some fifty: Kauffman's sum over the 2^n ways to
/// cut n crossings open (Kauffman 1987, "State models and the Jones polynomial"), times
/// (-A^3)^(-writhe), with t = A^-4. 1 for a line without a knot.
inline Complex jones(const std::vector<Vec3>& line) {
  std::vector<knots::Crossing> drawn;
  for (int i = 0; i < 50; ++i) {
    std::vector<Vec3> turned = line;
    const Vec3 axis = Vec3(std::sin(1. + i), std::sin(2. + 3 * i), std::sin(5. * i)).normalized();
    const Mat3 turn = Eigen::AngleAxis<Real>(0.3 + i, axis).toRotationMatrix();
    for (Vec3& p : turned) p = turn * p;
    auto found = knots::crossings_of_drawing(turned);
    if (i == 0 || found.size() < drawn.size()) drawn = std::move(found);
  }
  const std::size_t n = drawn.size();
  constexpr std::size_t most = 20;  // a million sums
  if (n > most) return 0;           // of no knot: the sum is never 0 there
  // Arcs are numbered by the passages that they begin at, over and under alike.
  std::map<Real, std::size_t> arcs;
  for (const auto& c : drawn) arcs[c.over] = arcs[c.under] = 0;
  std::size_t number = 0;
  for (auto& [place, arc] : arcs) arc = number++;
  const auto before = [&](std::size_t arc) { return (arc + 2 * n - 1) % (2 * n); };

  const Complex a = std::polar(1., -jones_angle / 4), loop = -a * a - 1. / (a * a);
  Complex sum = 0;
  int writhe = 0;
  for (const auto& c : drawn) writhe += c.sign;
  std::vector<std::size_t> root(2 * n);
  for (std::size_t state = 0; state < std::size_t(1) << n; ++state) {
    std::iota(root.begin(), root.end(), std::size_t(0));
    const auto find = [&](std::size_t i) {
      while (root[i] != i) i = root[i] = root[root[i]];
      return i;
    };
    int loops = static_cast<int>(2 * n), power = 0;
    const auto join = [&](std::size_t i, std::size_t j) {
      i = find(i), j = find(j);
      if (i == j) return;
      root[i] = j;
      --loops;
    };
    for (std::size_t k = 0; k < n; ++k) {
      const auto& c = drawn[k];
      const std::size_t over_out = arcs[c.over], under_out = arcs[c.under];
      const std::size_t over_in = before(over_out), under_in = before(under_out);
      const bool is_a = state >> k & 1;
      power += is_a ? 1 : -1;
      // Cut along the directions of the line, or across them; which of them is A depends on the
      // sign of the crossing.
      if (is_a == (c.sign > 0))
        join(over_in, under_out), join(under_in, over_out);
      else
        join(over_in, under_in), join(over_out, under_out);
    }
    sum += std::pow(a, power) * std::pow(loop, loops - 1);
  }
  if (n == 0) sum = 1;
  return sum * std::pow(-a * a * a, -writhe);
}

/// Of the torus knots of `crossings` (3, 5, 7), which is what a throw of one, two or three turns
/// closes to: t^(p-1)/2 (1 - t^(p+1) - t^3 + t^(p+2)) / (1 - t^2) (Jones 1987). Of its mirror
/// image, the conjugate; of knots one after another, the product.
inline Complex jones_of_throw(int crossings) {
  const auto t = [](Real power) { return std::polar(1., jones_angle * power); };
  const Real p = crossings;
  return t((p - 1) / 2) * (1. - t(p + 1) - t(3) + t(p + 2)) / (1. - t(2));
}

}  // namespace sutura::testing
