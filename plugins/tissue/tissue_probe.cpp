#include "tissue_probe.h"

#include <map>

#include "rotation.h"
#include "selection.h"

namespace sutura::tissue {
namespace {

Vec3 diagonal(const Mat3& m) {
  return m.diagonal();
}
Vec3 shear(const Mat3& m) {
  return {m(0, 1), m(1, 2), m(2, 0)};
}
Mat3 biot_strain(const Mat3& F) {
  const Mat3 U = nearest_rotation(F).transpose() * F;
  return 0.5 * (U + U.transpose()) - Mat3::Identity();
}

}  // namespace

void TissueProbe::describe(Describe<TissueProbe>& d) {
  using T = TissueProbe;
  d.summary(
      "Reads a tissue at a point, or on average over a box or a region: displacement, strain and "
      "stress.");
  d.theory(
      "Point, box and region are of the shape at rest and move with the material. Strain is that "
      "of Biot, *U - I* with *F = R U*, constant in each tetrahedron; stress is *2 mu e + lambda "
      "tr(e) I*; both are in the axes that the material had at rest. With `element=\"smoothed\"` "
      "the pressure of a tetrahedron is the mean of its corners', as the element has it at nodes. "
      "Averages are by volume at rest, over the tetrahedra whose middle lies in the box and that "
      "belong to the region; near nu = 0.5 those of few tetrahedra are rough.");
  d.link("tissue", &T::tissue_, "The tissue.");
  d.attribute("point", &T::point_, "m", any(), "The point, at rest.");
  d.attribute("box", &T::box_, "m", any(), "Instead of a point: two opposite corners of a box.");
  d.attribute("region", &T::region_, "Instead of a point: name or number of a region.");
  d.output("position", "m", "Where the point, or the middle of the part, is.",
           [](const T& p) { return p.position(); });
  d.output("displacement", "m", "How far it is from its place at rest.", [](const T& p) -> Vec3 {
    return p.mean(p.tissue_->positions()) - p.mean(p.tissue_->model().rest);
  });
  d.output("velocity", "m/s", "Its velocity.",
           [](const T& p) { return p.mean(p.tissue_->velocities()); });
  d.output("strain", "1", "Strain xx, yy, zz.", [](const T& p) { return diagonal(p.strain()); });
  d.output("shear_strain", "1", "Strain xy, yz, zx (half of the engineering shear).",
           [](const T& p) { return shear(p.strain()); });
  d.output("stress", "Pa", "Stress xx, yy, zz.", [](const T& p) { return diagonal(p.stress()); });
  d.output("shear_stress", "Pa", "Stress xy, yz, zx.",
           [](const T& p) { return shear(p.stress()); });
}

void TissueProbe::initialise(Setup& setup) {
  const bool part = !box_.empty() || !region_.empty();
  if (says("point") == part) {
    setup.error(*this, part ? "'point' and a part are both given; expected one of them"
                            : "one of 'point', 'box' and 'region' is needed");
    return;
  }
  if (part ? over_part(setup) : at_point(setup)) find_corners();
}

bool TissueProbe::at_point(Setup& setup) {
  std::optional<EmbeddedPoint> at = tissue_->locate(point_, Configuration::rest);
  if (!at) {
    // A point of the surface may lie outside by its rounding.
    const MeshReport& report = tissue_->mesh->report();
    const Real rounding = 1e-6 * (report.high - report.low).norm();
    if (const auto near = tissue_->closest_surface(point_, rounding, Configuration::rest))
      at = near->at;
  }
  if (!at) {
    setup.error(*this, "'point' is not inside the tissue at rest");
    return false;
  }
  const Tet& tet = tissue_->mesh->data().tets[static_cast<std::size_t>(at->element)];
  for (std::size_t k = 0; k < 4; ++k) nodes_.push_back({tet[k], at->weights[k]});
  tets_.push_back({at->element, 1});
  return true;
}

bool TissueProbe::over_part(Setup& setup) {
  std::string error;
  const std::optional<Selection> part = select(*tissue_->mesh, box_, region_, error);
  if (!part) {
    setup.error(*this, error);
    return false;
  }
  if (part->tets.empty()) {
    setup.error(*this, "no tetrahedron of the tissue has its middle in the part");
    return false;
  }
  const MeshData& data = tissue_->mesh->data();
  std::map<Index, Real> nodes;
  Real volume = 0;
  for (const Index e : part->tets) {
    const Tet& t = data.tets[static_cast<std::size_t>(e)];
    const Real own =
        six_volume(data.points[t[0]], data.points[t[1]], data.points[t[2]], data.points[t[3]]) / 6;
    volume += own;
    tets_.push_back({e, own});
    for (const Index i : t) nodes[i] += own / 4;
  }
  for (Share& s : tets_) s.weight /= volume;
  for (const auto& [node, weight] : nodes) nodes_.push_back({node, weight / volume});
  return true;
}

Vec3 TissueProbe::mean(const VecX& nodal) const {
  Vec3 sum = Vec3::Zero();
  for (const Share& s : nodes_) sum += s.weight * nodal.segment<3>(3 * s.number);
  return sum;
}

/// The tets around each corner that are of the same material, with their shares of the volume.
void TissueProbe::find_corners() {
  if (!tissue_->model().elastic->averages_volume()) return;
  const MeshData& data = tissue_->mesh->data();
  std::vector<std::vector<Share>> around(data.points.size());
  for (std::size_t e = 0; e < data.tets.size(); ++e) {
    const Tet& t = data.tets[e];
    const Real volume =
        six_volume(data.points[t[0]], data.points[t[1]], data.points[t[2]], data.points[t[3]]) / 6;
    for (const Index node : t)
      around[static_cast<std::size_t>(node)].push_back({static_cast<Index>(e), volume});
  }
  const auto material = [&](Index tet) {
    const Elasticity of = tissue_->elasticity({.element = tet});
    return std::pair(of.young, of.poisson);
  };
  for (const Share& own : tets_) {
    corners_.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) {
      std::vector<Share>& corner = corners_.back()[k];
      corner = around[static_cast<std::size_t>(data.tets[static_cast<std::size_t>(own.number)][k])];
      std::erase_if(corner,
                    [&](const Share& s) { return material(s.number) != material(own.number); });
      Real sum = 0;
      for (const Share& s : corner) sum += s.weight;
      for (Share& s : corner) s.weight /= sum;
    }
  }
}

Mat3 TissueProbe::gradient(Index tet) const {
  const Tet& t = tissue_->mesh->data().tets[static_cast<std::size_t>(tet)];
  return deformation_gradient(t, tissue_->model().rest, tissue_->positions());
}

Mat3 TissueProbe::strain() const {
  Mat3 sum = Mat3::Zero();
  for (const Share& s : tets_) sum += s.weight * biot_strain(gradient(s.number));
  return sum;
}

/// Trace of the strain that the element gives to a tet.
Real TissueProbe::volume_strain(std::size_t tet) const {
  if (corners_.empty()) return biot_strain(gradient(tets_[tet].number)).trace();
  Real sum = 0;
  for (const std::vector<Share>& corner : corners_[tet]) {
    Mat3 F = Mat3::Zero();
    for (const Share& s : corner) F += s.weight * gradient(s.number);
    sum += biot_strain(F).trace() / 4;
  }
  return sum;
}

Mat3 TissueProbe::stress() const {
  Mat3 sum = Mat3::Zero();
  for (std::size_t i = 0; i < tets_.size(); ++i) {
    const Elasticity elastic = tissue_->elasticity({.element = tets_[i].number});
    const Material m{elastic.young, elastic.poisson, 0};
    const Mat3 e = biot_strain(gradient(tets_[i].number));
    const Real pressure = (m.lame_lambda() + 2 * m.lame_mu() / 3) * volume_strain(i);
    sum += tets_[i].weight *
           (2 * m.lame_mu() * (e - e.trace() / 3 * Mat3::Identity()) + pressure * Mat3::Identity());
  }
  return sum;
}

}  // namespace sutura::tissue
