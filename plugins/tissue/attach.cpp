#include "attach.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "selection.h"
#include "sutura/text.h"
#include "sutura/units.h"
#include "tet_mesh.h"

namespace sutura::tissue {
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
      "Holds the nodes of a tissue that lie in a box at rest, in a region of the mesh, or are "
      "listed: where they are, along some directions only, or on a motion.");
  d.theory(
      "Nodes held along all directions are taken out of the equations: they are exactly where they "
      "are told. Nodes held along some directions slide along the others; a spring a million times "
      "stiffer than the tissue around them holds them. With `motion` each node goes to *x(t)* of "
      "the motion, from its place at rest.");
  d.attribute(
      "box", &Attach::box, "m", any(),
      "Two opposite corners: x y z of the lower, x y z of the upper; nodes on the faces count.");
  d.attribute("nodes", &Attach::nodes, "1", at_least(0),
              "Nodes by number, from 0, in the order of the mesh (unused ones left out).");
  d.attribute("region", &Attach::region,
              "Name or number of a region of the mesh: its nodes, or those of them in 'box'.");
  d.attribute("directions", &Attach::directions,
              "Along which axes the nodes are held: 'xyz', or some of the letters.");
  d.link("tissue", &Attach::tissue, "The tissue to hold.");
  d.link("motion", &Attach::motion, "What the nodes follow, a Track for instance; left out: none.")
      .named_only();
  d.output("nodes_held", "1", "Number of nodes held.",
           [](const Attach& a) -> Real { return static_cast<Real>(a.selected_.size()); });
  d.output("reaction", "N",
           "Force with which this attachment holds the tissue, at the end of the last step. "
           "Where several hold a node along the same axis, each has its share.",
           [](const Attach& a) -> Vec3 {
             return a.tissue->reaction(a.selected_).cwiseProduct(a.along_);
           });
}

void Attach::initialise(Setup& setup) {
  if (box.empty() && nodes.empty() && region.empty())
    return setup.error(*this, "one of 'box', 'region' and 'nodes' is needed");
  std::array<bool, 3> along{};
  for (const char letter : directions) {
    const auto axis = std::string("xyz").find(letter);
    if (axis == std::string::npos || along[axis])
      return setup.error(*this, "'directions' is " + in_quotes(directions) +
                                    ", expected some of the letters x, y and z, each once");
    along[axis] = true;
    along_[static_cast<Index>(axis)] = 1;
  }
  if (directions.empty()) return setup.error(*this, "'directions' is empty; nothing would be held");
  const Index count = static_cast<Index>(tissue->mesh->data().points.size());
  if (!box.empty() || !region.empty()) {
    std::string error;
    const std::optional<Selection> selection = select(*tissue->mesh, box, region, error);
    if (!selection) return setup.error(*this, error);
    selected_ = selection->nodes;
    if (selected_.empty())
      return setup.error(*this,
                         std::string("no node of ") + (region.empty() ? "the tissue" : "'region'") +
                             " lies in 'box'; the mesh spans " + corners(tissue->mesh->report()) +
                             (tissue->mesh->unit == TetMesh::Unit::unstated
                                  ? ", taken for metres: is a unit=\"mm\" missing?"
                                  : ""));
  }
  for (const Real number : nodes) {
    if (number != std::floor(number) || number >= static_cast<Real>(count))
      return setup.error(*this, "'nodes' names node " + plain_number(number) +
                                    ", expected whole numbers from 0 to " +
                                    std::to_string(count - 1));
    selected_.push_back(static_cast<Index>(number));
  }
  std::sort(selected_.begin(), selected_.end());
  selected_.erase(std::unique(selected_.begin(), selected_.end()), selected_.end());
  HeldNodes& held = tissue->model().held;
  slides_ = !(along[0] && along[1] && along[2]);
  if (!slides_) {
    const Index contradicted = held.fix(selected_, motion.get());
    if (contradicted > 0)
      setup.warning(*this, std::to_string(contradicted) +
                               " of its nodes are held by another Attach, which does not move them "
                               "as this one does; the last that moves them does");
  }
  for (const Index node : selected_) {
    if (slides_)
      handles_.push_back(tissue->support(node, along));
    else if (motion)
      handles_.push_back(held.carrier(node, tissue->model().rest.segment<3>(3 * node)));
  }
}

void Attach::drive(const StepContext&) {
  if (!motion) return;
  const Pose pose = motion->pose();
  TissueModel& model = tissue->model();
  for (std::size_t i = 0; i < selected_.size(); ++i) {
    const Vec3 rest = model.rest.segment<3>(3 * selected_[i]);
    const Vec3 target = pose.position + pose.rotation * rest;
    if (slides_)
      model.held.carry_support(handles_[i], target);
    else
      model.held.carry(handles_[i], target);
  }
}

}  // namespace sutura::tissue
