#include "tissue_fields.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "rotation.h"

namespace sutura::tissue {

Real sum(std::span<const Real> values) {
  Real sum = 0;
  for (const Real value : values) sum += value;
  return sum;
}

Vec3 momentum(const TissueModel& model, const VecX& v) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < model.mass.size(); ++i)
    sum += model.mass[i] * v.segment<3>(3 * static_cast<Index>(i));
  return sum;
}

Vec3 centre_of_mass(const TissueModel& model, const VecX& x) {
  return momentum(model, x) / sum(model.mass);  // the same sum, of positions
}

Real kinetic_energy(const TissueModel& model, const VecX& v) {
  Real kinetic = 0;
  for (std::size_t i = 0; i < model.mass.size(); ++i)
    kinetic += 0.5 * model.mass[i] * v.segment<3>(3 * static_cast<Index>(i)).squaredNorm();
  return kinetic;
}

Index inverted_tets(const TissueModel& model, const VecX& x) {
  Index count = 0;
  for (const Tet& t : model.mesh->tets)
    if (!(six_volume(x.segment<3>(3 * t[0]), x.segment<3>(3 * t[1]), x.segment<3>(3 * t[2]),
                     x.segment<3>(3 * t[3])) > 0))
      ++count;
  return count;
}

// A shear by a at a uniform compression of the volume by e costs (2 mu - lambda e) a^2 / 2 and no
// more: beyond e = 2 mu / lambda the material folds. A neo-Hookean one with the same constants does
// not.
Real collapsed_share(const TissueModel& model, const VecX& x) {
  const std::vector<Vec3>& rest = model.mesh->points;
  Real all = 0, collapsed = 0;
  for (std::size_t e = 0; e < model.mesh->tets.size(); ++e) {
    const Tet& t = model.mesh->tets[e];
    const Real nu = model.materials[e].poisson;
    const Real before = six_volume(rest[t[0]], rest[t[1]], rest[t[2]], rest[t[3]]);
    const Real now = six_volume(x.segment<3>(3 * t[0]), x.segment<3>(3 * t[1]),
                                x.segment<3>(3 * t[2]), x.segment<3>(3 * t[3]));
    all += before;
    if (nu * (before - now) > (1 - 2 * nu) * before) collapsed += before;
  }
  return collapsed / all;
}

Real max_displacement(const TissueModel& model, const VecX& x) {
  Real most = 0;
  for (Index i = 0; i < model.dofs(); i += 3)
    most = std::max(most, (x.segment<3>(i) - model.rest.segment<3>(i)).norm());
  return most;
}

Vec3 lowest_node(const VecX& x) {
  Index best = 0;
  for (Index i = 3; i < x.size(); i += 3)
    if (x[i + 2] < x[best + 2]) best = i;
  return x.segment<3>(best);
}

BodyGeometry geometry(const TissueModel& model, const VecX& x, const VecX& v) {
  const MeshData& data = *model.mesh;
  BodyGeometry g;
  g.cell = BodyGeometry::Cell::tetrahedron;
  BodyGeometry::Field displacement{"displacement [m]", false, 3, {}},
      velocity{"velocity [m/s]", false, 3, {}}, held{"held", false, 1, {}},
      region{"region", true, 1, {}}, stress{"von Mises stress [Pa]", true, 1, {}},
      strain{"largest stretch", true, 1, {}};
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    const Index k = 3 * static_cast<Index>(i);
    g.points.push_back(x.segment<3>(k));
    for (Index c = k; c < k + 3; ++c) {
      displacement.values.push_back(x[c] - model.rest[c]);
      velocity.values.push_back(v[c]);
    }
    held.values.push_back(model.held.is_fixed(static_cast<Index>(i)) ? 1 : 0);
  }
  Eigen::SelfAdjointEigenSolver<Mat3> squares;  // of stretches
  for (std::size_t e = 0; e < data.tets.size(); ++e) {
    const Tet& t = data.tets[e];
    g.connectivity.insert(g.connectivity.end(), t.begin(), t.end());
    region.values.push_back(data.region[e]);
    const Mat3 F = deformation_gradient(t, data.points, x);
    const Mat3 S = nearest_rotation(F).transpose() * F;
    const Mat3 deviator = 0.5 * (S + S.transpose()) - S.trace() / 3 * Mat3::Identity();
    stress.values.push_back(2 * model.materials[e].lame_mu() * std::sqrt(1.5) * deviator.norm());
    squares.computeDirect(F.transpose() * F, Eigen::EigenvaluesOnly);
    strain.values.push_back(std::sqrt(squares.eigenvalues()[2]));
  }
  g.fields = {std::move(displacement), std::move(velocity), std::move(held),
              std::move(region),       std::move(stress),   std::move(strain)};
  return g;
}

}  // namespace sutura::tissue
