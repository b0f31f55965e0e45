#include "constraint_grid.h"

#include <algorithm>

#include "sutura/archive.h"

namespace sutura::output {

int LawNumbers::number(const std::string& law) {
  const auto found = std::find(names_.begin(), names_.end(), law);
  if (found == names_.end()) {
    names_.push_back(law);
    return static_cast<int>(names_.size()) - 1;
  }
  return static_cast<int>(found - names_.begin());
}

void LawNumbers::archive(Archive& a) {
  a.list("laws", names_, [](Archive& each, std::string& name) { each("law", name); });
}

std::vector<std::pair<std::string, int>> LawNumbers::legend() const {
  std::vector<std::pair<std::string, int>> out;
  for (const std::string& name : names_) {
    const int i = static_cast<int>(out.size());
    out.emplace_back("law " + std::to_string(i) + " is " + name, i);
  }
  return out;
}

VtuGrid constraint_grid(const ConstraintProblem& problem, LawNumbers& laws) {
  VtuGrid grid;
  grid.cell = VtkCell::vertex;
  BodyGeometry::Field force{"force [N]", false, 3, {}};
  BodyGeometry::Field lambda{"lambda [N]", false, 1, {}};
  BodyGeometry::Field delta{"delta [m]", false, 1, {}};
  BodyGeometry::Field violation{"violation [m]", false, 1, {}};
  BodyGeometry::Field mode{"mode", false, 1, {}};
  BodyGeometry::Field law{"law", false, 1, {}};
  for (const ConstraintBlock& b : problem.blocks) {
    grid.connectivity.push_back(static_cast<Index>(grid.points.size()));
    grid.points.push_back(b.at);
    const Vec3 f = problem.block_force(b);
    force.values.insert(force.values.end(), f.data(), f.data() + 3);
    lambda.values.push_back(problem.lambda.segment(b.first_row, b.law->dim).norm());
    delta.values.push_back(problem.delta.segment(b.first_row, b.law->dim).norm());
    violation.values.push_back(b.violation);
    mode.values.push_back(b.mode);
    law.values.push_back(laws.number(b.law->name));
  }
  if (problem.blocks.empty()) {
    // Readers such as meshio refuse a grid without cells, and a step left out would show the arrows
    // of the step before: one vertex with no force and the law -1 stands for "none".
    grid.points = {Vec3::Zero()};
    grid.connectivity = {0};
    force.values = {0, 0, 0};
    lambda.values = delta.values = violation.values = mode.values = {0};
    law.values = {-1};
  }
  grid.fields = {std::move(force),     std::move(lambda), std::move(delta),
                 std::move(violation), std::move(mode),   std::move(law)};
  grid.constants = laws.legend();
  return grid;
}

}  // namespace sutura::output
