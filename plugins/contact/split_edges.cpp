#include "split_edges.h"

#include <algorithm>
#include <map>
#include <tuple>

namespace sutura::contact {
namespace {

constexpr Real least_turn = 1e-3;  // rad: at an edge whose sides turn by less the surface is flat

/// A closed surface of which edges can be halved.
class Splitting {
 public:
  explicit Splitting(TriangleData surface) : surface_(std::move(surface)) {
    for (std::size_t t = 0; t < triangles().size(); ++t) add(t);
  }

  /// Until no convex edge is longer.
  void split(Real longest) {
    std::vector<Edge> waiting;
    const auto ask = [&](const Edge& e) {
      if (length(e) > longest && is_convex(e)) waiting.push_back(e);
    };
    for (const auto& [edge, sides] : sides_) ask(edge);
    while (!waiting.empty()) {
      const Edge edge = waiting.back();
      if (!sides_.contains(edge)) {
        waiting.pop_back();  // halved on behalf of another one, which has asked for its halves
        continue;
      }
      // Along triangles with ever longer edges, to one that is the longest of both its triangles.
      Edge last = edge;
      for (Edge next = longest_beside(last); next != last; next = longest_beside(last)) last = next;
      const bool goes_on = is_convex(last);
      const Index middle = halve(last);
      if (goes_on) ask(ordered(last.first, middle)), ask(ordered(middle, last.second));
    }
  }

  TriangleData take() { return std::move(surface_); }

 private:
  using Edge = std::pair<Index, Index>;  // the lower number first
  /// The triangle that runs from its first point to its second, and the other one.
  struct Sides {
    std::size_t up = 0, down = 0;
  };

  static Edge ordered(Index a, Index b) { return {std::min(a, b), std::max(a, b)}; }
  std::vector<std::array<Index, 3>>& triangles() { return surface_.triangles; }
  const Vec3& point(Index i) const { return surface_.points[static_cast<std::size_t>(i)]; }
  Real length(const Edge& e) const { return (point(e.second) - point(e.first)).norm(); }

  void add(std::size_t t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = triangles()[t][k], b = triangles()[t][(k + 1) % 3];
      Sides& sides = sides_[ordered(a, b)];
      (a < b ? sides.up : sides.down) = t;
    }
  }

  Index opposite(std::size_t t, const Edge& e) {
    const auto& c = triangles()[t];
    return *std::find_if(c.begin(), c.end(),
                         [&](Index i) { return i != e.first && i != e.second; });
  }

  /// Does the surface turn away from its outside there?
  bool is_convex(const Edge& e) {
    const Sides& sides = sides_.at(e);
    const Vec3 along = point(e.second) - point(e.first);
    const Vec3 up = along.cross(point(opposite(sides.up, e)) - point(e.first));
    const Vec3 down = (point(opposite(sides.down, e)) - point(e.first)).cross(along);
    return up.cross(down).dot(along) > least_turn * up.norm() * down.norm() * along.norm();
  }

  /// Of the triangles beside an edge; of two that are as long that with the higher numbers.
  Edge longest_beside(const Edge& e) {
    const Sides& sides = sides_.at(e);
    Edge best = e;
    for (const std::size_t t : {sides.up, sides.down})
      for (std::size_t k = 0; k < 3; ++k) {
        const Edge other = ordered(triangles()[t][k], triangles()[t][(k + 1) % 3]);
        if (std::tuple(length(other), other) > std::tuple(length(best), best)) best = other;
      }
    return best;
  }

  /// Both of its triangles become two.
  Index halve(const Edge& e) {
    const Sides sides = sides_.at(e);
    const Index middle = static_cast<Index>(surface_.points.size());
    surface_.points.push_back((point(e.first) + point(e.second)) / 2);
    sides_.erase(e);
    for (const std::size_t t : {sides.up, sides.down}) {
      std::array<Index, 3> half = triangles()[t];
      std::replace(triangles()[t].begin(), triangles()[t].end(), e.second, middle);
      std::replace(half.begin(), half.end(), e.first, middle);
      triangles().push_back(half);
      add(t);
      add(triangles().size() - 1);
    }
    return middle;
  }

  TriangleData surface_;
  std::map<Edge, Sides> sides_;
};

}  // namespace

TriangleData split_convex_edges(TriangleData surface, Real longest) {
  Splitting splitting(std::move(surface));
  if (longest > 0) splitting.split(longest);
  return splitting.take();
}

}  // namespace sutura::contact
