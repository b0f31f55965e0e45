#include "free_motion.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstdio>
#include <map>
#include <vector>

#include "mesh_check.h"

namespace sutura::tissue {
namespace {

/// Nodes that are connected, part by part.
std::vector<std::vector<Index>> parts_of(const MeshData& mesh) {
  const std::vector<Index> first = first_of_part(mesh);
  std::map<Index, std::vector<Index>> by_first;
  for (std::size_t i = 0; i < first.size(); ++i)
    by_first[first[i]].push_back(static_cast<Index>(i));
  std::vector<std::vector<Index>> parts;
  for (auto& [_, nodes] : by_first) parts.push_back(std::move(nodes));
  return parts;
}

/// How these nodes can move as one, "along x"; empty if they cannot.
std::string motion_of(const TissueModel& model, const std::vector<Index>& nodes) {
  const auto at = [&](Index i) -> Vec3 { return model.rest.segment<3>(3 * i); };
  Vec3 centre = Vec3::Zero();
  for (const Index i : nodes) centre += at(i) / static_cast<Real>(nodes.size());
  Real size = 0;
  for (const Index i : nodes) size = std::max(size, (at(i) - centre).norm());
  // What a rigid motion, three translations and three rotations, moves of what is held.
  using Mat6 = Eigen::Matrix<Real, 6, 6>;
  Mat6 held = Mat6::Zero();
  for (const Index i : nodes)
    for (Index k = 0; k < 3; ++k) {
      if (!(model.held.holders(i)[k] > 0)) continue;
      Eigen::Matrix<Real, 6, 1> row;
      row << Vec3::Unit(k), ((at(i) - centre) / size).cross(Vec3::Unit(k));
      held += row * row.transpose();
    }
  if (held.isZero(0)) return "in every direction";
  for (Index k = 0; k < 3; ++k)
    if (!(held(k, k) > 0)) return std::string("along ") + "xyz"[k];
  const Eigen::SelfAdjointEigenSolver<Mat6> modes(held, Eigen::EigenvaluesOnly);
  constexpr Real rounding = 1e-9;
  return modes.eigenvalues()[0] > rounding * modes.eigenvalues()[5] ? "" : "by turning";
}

}  // namespace

std::string free_motion(const TissueModel& model) {
  const auto parts = parts_of(*model.mesh);
  for (const std::vector<Index>& nodes : parts) {
    const std::string motion = motion_of(model, nodes);
    if (motion.empty()) continue;
    const std::string so = "free to move " + motion + ", as no Attach keeps it from that";
    if (parts.size() == 1) return "it is " + so;
    char where[100];
    const Vec3 p = 1e3 * model.rest.segment<3>(3 * nodes.front());
    std::snprintf(where, sizeof where, "%.4g %.4g %.4g mm", p.x(), p.y(), p.z());
    return "one of its " + std::to_string(parts.size()) + " parts, with a node at " + where +
           ", is " + so;
  }
  return {};
}

}  // namespace sutura::tissue
