#include "attach.h"

#include <cmath>
#include <cstdio>

#include "tet_mesh.h"

namespace sutura {
namespace {

/// "-0.025 -0.015 -0.01  0.025 0.015 0 m", as 'box' would say it.
std::string corners(const MeshReport& mesh) {
  std::string out;
  for (const Vec3& corner : {mesh.low, mesh.high})
    for (const Real x : corner) {
      char text[32];
      std::snprintf(text, sizeof text, "%.4g ", x);
      out += text;
    }
  return out + "m";
}

}  // namespace

void Attach::describe(Describe<Attach>& d) {
  d.summary(
      "Fixes the nodes of a tissue that lie in a box at rest, or are listed, exactly where they "
      "are.");
  d.attribute(
      "box", &Attach::box, "m", any(),
      "Two opposite corners: x y z of the lower, x y z of the upper; nodes on the faces count.");
  d.attribute("nodes", &Attach::nodes, "1", at_least(0),
              "Nodes by number, from 0, in the order of the mesh (unused ones left out).");
  d.link("tissue", &Attach::tissue, "The tissue to hold.");
  d.output("nodes_held", "1", "Number of nodes held.",
           [](const Attach& a) -> Real { return static_cast<Real>(a.selected_.size()); });
  d.output("reaction", "N",
           "Force with which this attachment holds the tissue, over the last step.",
           [](const Attach& a) -> Vec3 { return a.tissue->reaction(a.selected_); });
}

void Attach::initialise(Setup& setup) {
  if (box.empty() && nodes.empty()) return setup.error(*this, "one of 'box' and 'nodes' is needed");
  const std::vector<Vec3>& points = tissue->mesh->data().points;
  const Index count = static_cast<Index>(points.size());
  if (!box.empty()) {
    if (box.size() != 6)
      return setup.error(
          *this, "'box' has " + std::to_string(box.size()) + " numbers, expected 6: two corners");
    const Vec3 a(box[0], box[1], box[2]), b(box[3], box[4], box[5]);
    const Vec3 low = a.cwiseMin(b), high = a.cwiseMax(b);
    // Corners and coordinates may come from different units: forgive the rounding of a conversion.
    const Real rounding = 1e-9 * (tissue->mesh->report().high - tissue->mesh->report().low).norm();
    for (Index i = 0; i < count; ++i)
      if (((points[i] - low).array() >= -rounding).all() &&
          ((high - points[i]).array() >= -rounding).all())
        selected_.push_back(i);
    if (selected_.empty())
      return setup.error(*this, "no node of the tissue lies in 'box'; the mesh spans " +
                                    corners(tissue->mesh->report()) +
                                    (tissue->mesh->unit == TetMesh::Unit::unstated
                                         ? ", taken for metres: is a unit=\"mm\" missing?"
                                         : ""));
  }
  for (const Real number : nodes) {
    if (number != std::floor(number) || number >= static_cast<Real>(count))
      return setup.error(*this, "'nodes' names node " + std::to_string(number) +
                                    ", expected whole numbers from 0 to " +
                                    std::to_string(count - 1));
    selected_.push_back(static_cast<Index>(number));
  }
  std::sort(selected_.begin(), selected_.end());
  selected_.erase(std::unique(selected_.begin(), selected_.end()), selected_.end());
  tissue->fix(selected_);
}

}  // namespace sutura
