#include "knot_type.h"

#include <algorithm>
#include <array>
#include <map>
#include <numbers>

#include "sutura/geometry/poses.h"

namespace sutura::contact {
namespace {

using Complex = std::complex<Real>;

constexpr std::size_t most_crossings = 60, most_states = 20000;
constexpr Real angle_of_type = 1;  // no root of unity, where knots could look alike

/// Where a drawing crosses itself: places along the line, and the sign by the right-hand rule.
struct Crossing {
  Real over = 0, under = 0;
  int sign = 1;
};

/// In the drawing onto the x y plane of the line as it stands after `turn`.
std::vector<Crossing> draw(const std::vector<Vec3>& line, const Mat3& turn) {
  std::vector<Vec3> at;
  at.reserve(line.size());
  for (const Vec3& p : line) at.push_back(turn * p);
  std::vector<Crossing> out;
  const auto area = [](const Vec3& u, const Vec3& v) { return u.x() * v.y() - u.y() * v.x(); };
  for (std::size_t i = 0; i + 1 < at.size(); ++i)
    for (std::size_t j = i + 2; j + 1 < at.size(); ++j) {
      const Vec3 a = at[i + 1] - at[i], b = at[j + 1] - at[j], between = at[j] - at[i];
      const Real wide = area(a, b);
      if (wide == 0) continue;
      const Real u = area(between, b) / wide, v = area(between, a) / wide;
      if (!(u >= 0 && u < 1 && v >= 0 && v < 1)) continue;
      const bool first_is_over = at[i].z() + u * a.z() > at[j].z() + v * b.z();
      const Real here = static_cast<Real>(i) + u, there = static_cast<Real>(j) + v;
      out.push_back({first_is_over ? here : there, first_is_over ? there : here,
                     (wide > 0) == first_is_over ? 1 : -1});
    }
  return out;
}

/// The drawing with the fewest crossings of some.
std::vector<Crossing> simplest_drawing(const std::vector<Vec3>& line) {
  constexpr int drawings = 16;
  std::vector<Crossing> best;
  for (int i = 0; i < drawings; ++i) {
    const Vec3 axis(std::sin(1. + i), std::sin(2. + 3 * i), std::sin(5. * i + 0.3));
    auto drawn = draw(line, Eigen::AngleAxis<Real>(0.3 + i, axis.normalized()).toRotationMatrix());
    if (i == 0 || drawn.size() < best.size()) best = std::move(drawn);
  }
  return best;
}

/// The arcs between the passages of a line. Of each, the two ends: where it leaves a crossing, and
/// where it comes to the next.
struct Passages {
  std::size_t over_in, over_out, under_in, under_out;  // ends
};
std::vector<Passages> passages(const std::vector<Crossing>& crossings) {
  std::map<Real, std::size_t> number;
  for (const Crossing& c : crossings) number[c.over] = number[c.under] = 0;
  std::size_t next = 0;
  for (auto& [place, passage] : number) passage = next++;
  std::vector<Passages> out;
  for (const Crossing& c : crossings) {
    const std::size_t over = number[c.over], under = number[c.under];
    out.push_back({2 * over + 1, 2 * over + 2, 2 * under + 1, 2 * under + 2});
  }
  return out;
}

/// Crossings so that each has as many arcs as possible in common with those before.
std::vector<std::size_t> good_order(const std::vector<Passages>& all) {
  std::vector<std::size_t> order;
  std::vector<char> used(all.size(), 0), seen(2 * all.size() + 1, 0);
  const auto arcs = [](const Passages& p) {
    return std::array{p.over_in / 2, p.over_out / 2, p.under_in / 2, p.under_out / 2};
  };
  while (order.size() < all.size()) {
    std::size_t best = 0;
    int most = -1;
    for (std::size_t k = 0; k < all.size(); ++k) {
      int common = 0;
      for (const std::size_t arc : arcs(all[k])) common += seen[arc];
      if (!used[k] && common > most) most = common, best = k;
    }
    used[best] = 1;
    order.push_back(best);
    for (const std::size_t arc : arcs(all[best])) seen[arc] = 1;
  }
  return order;
}

/// How the ends that are still open are joined, and with which weight.
using Joined = std::vector<std::size_t>;
using Sum = std::map<Joined, Complex>;

/// Joins two ends; true if that closes a loop.
bool join(Joined& other, std::size_t x, std::size_t y) {
  const std::size_t p = other[x], q = other[y];
  other[x] = x, other[y] = y;
  if (p == y) return true;
  other[p] = q, other[q] = p;
  return false;
}

std::optional<Complex> bracket(const std::vector<Crossing>& crossings, Complex a) {
  if (crossings.size() > most_crossings) return {};
  const std::vector<Passages> all = passages(crossings);
  Joined arcs(2 * (2 * crossings.size() + 1));
  for (std::size_t i = 0; i < arcs.size(); ++i) arcs[i] = i ^ 1;
  Sum sum{{arcs, 1.}};
  const Complex loop = -a * a - 1. / (a * a);
  for (const std::size_t k : good_order(all)) {
    const Passages& p = all[k];
    Sum next;
    for (const auto& [joined, weight] : sum)
      for (const bool is_a : {true, false}) {
        Joined now = joined;
        Complex w = weight * (is_a ? a : 1. / a);
        // Cut open along the directions of the line, or across them.
        const bool along = is_a == (crossings[k].sign > 0);
        if (join(now, p.over_in, along ? p.under_out : p.under_in)) w *= loop;
        if (join(now, along ? p.under_in : p.over_out, along ? p.over_out : p.under_out)) w *= loop;
        next[now] += w;
      }
    sum = std::move(next);
    if (sum.size() > most_states) return {};
  }
  return sum.begin()->second;  // the one line that is left
}

std::optional<Complex> jones_of(const std::vector<Crossing>& crossings, Real angle) {
  const Complex a = std::polar(1., -angle / 4);
  const std::optional<Complex> sum = bracket(crossings, a);
  if (!sum) return {};
  int writhe = 0;
  for (const Crossing& c : crossings) writhe += c.sign;
  return *sum * std::pow(-a * a * a, -writhe);
}

/// Of a right-handed throw.
Complex jones_of_throw(Index crossings, Real angle) {
  const auto t = [angle](Real power) { return std::polar(1., angle * power); };
  const auto p = static_cast<Real>(crossings);
  return t((p - 1) / 2) * (1. - t(p + 1) - t(3) + t(p + 2)) / (1. - t(2));
}

/// Throws whose product that is.
void count_throws(Complex wanted, KnotType& type) {
  constexpr Index most_throws = 6;
  constexpr Real rounding = 1e-6;
  constexpr std::array<Index, 3> kinds = {3, 5, 7};
  // Numbers of right- and left-handed throws of each kind; those of few throws first.
  std::array<Index, 6> n{};
  for (Index throws = 1; throws <= most_throws && !type.is_known; ++throws)
    for (n[5] = 0; n[5] <= throws; ++n[5])
      for (n[4] = 0; n[4] <= throws; ++n[4])
        for (n[3] = 0; n[3] <= throws; ++n[3])
          for (n[2] = 0; n[2] <= throws; ++n[2])
            for (n[1] = 0; n[1] <= throws; ++n[1]) {
              n[0] = throws - n[1] - n[2] - n[3] - n[4] - n[5];
              if (n[0] < 0) break;
              Complex product = 1;
              Real determinant = 1;
              Index crossings = 0;
              for (std::size_t k = 0; k < 6; ++k) {
                const Complex one = jones_of_throw(kinds[k / 2], angle_of_type);
                for (Index i = 0; i < n[k]; ++i) {
                  product *= k % 2 == 0 ? one : std::conj(one);
                  determinant *= static_cast<Real>(kinds[k / 2]);
                  crossings += kinds[k / 2];
                }
              }
              if (type.is_known || std::abs(product - wanted) > rounding * std::abs(product) ||
                  std::abs(determinant - type.determinant) > 0.1)
                continue;
              type.is_known = true;
              type.throws = throws;
              type.left = n[1] + n[3] + n[5];
              type.crossings = crossings;
            }
}

}  // namespace

std::optional<Complex> jones(const std::vector<Vec3>& line, Real angle) {
  return jones_of(simplest_drawing(line), angle);
}

std::vector<Vec3> simplified(const std::vector<Vec3>& line, Real off) {
  std::vector<Vec3> out(1, line.front());
  for (std::size_t from = 0, to = 2; from + 1 < line.size(); ++to) {
    const auto is_near = [&](const Vec3& p) {
      const Vec3 way = line[to] - line[from];
      const Real part = std::clamp((p - line[from]).dot(way) / way.squaredNorm(), 0., 1.);
      return (p - line[from] - part * way).norm() <= off;
    };
    bool straight = to < line.size();
    for (std::size_t k = from + 1; k < to && straight; ++k) straight = is_near(line[k]);
    if (straight) continue;
    from = to - 1;
    out.push_back(line[from]);
  }
  return out;
}

KnotType knot_type(const std::vector<Vec3>& line) {
  KnotType type;
  const std::vector<Crossing> drawn = simplest_drawing(line);
  const auto there = jones_of(drawn, angle_of_type),
             at_minus_one = jones_of(drawn, std::numbers::pi);
  if (!there || !at_minus_one) {
    type.is_knot = true;  // with so many crossings that is more likely than not
    type.determinant = 0;
    return type;
  }
  constexpr Real rounding = 1e-6;
  type.determinant = std::round(std::abs(*at_minus_one));
  type.is_knot = std::abs(*there - 1.) > rounding;
  type.is_known = !type.is_knot;
  if (type.is_knot) count_throws(*there, type);
  return type;
}

}  // namespace sutura::contact
