// What a tissue shows: sums over its state, and fields for recorders.
#include <Eigen/Eigenvalues>  // operatorNorm
#include <cmath>

#include "rotation.h"
#include "tissue.h"

namespace sutura {

Vec3 Tissue::reaction(const std::vector<Index>& nodes) const {
  Vec3 sum = Vec3::Zero();
  for (const Index i : nodes) sum += reaction_.segment<3>(3 * i);
  return sum;
}

Index Tissue::inverted() const {
  Index count = 0;
  for (const Tet& t : mesh->data().tets)
    if (!(six_volume(x_.segment<3>(3 * t[0]), x_.segment<3>(3 * t[1]), x_.segment<3>(3 * t[2]),
                     x_.segment<3>(3 * t[3])) > 0))
      ++count;
  return count;
}

Real Tissue::max_displacement() const {
  Real most = 0;
  for (Index i = 0; i < dofs(); i += 3)
    most = std::max(most, (x_.segment<3>(i) - rest_.segment<3>(i)).norm());
  return most;
}

Vec3 Tissue::lowest() const {
  Index best = 0;
  for (Index i = 3; i < dofs(); i += 3)
    if (x_[i + 2] < x_[best + 2]) best = i;
  return x_.segment<3>(best);
}

Vec3 Tissue::momentum() const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < mass_.size(); ++i)
    sum += mass_[i] * v_.segment<3>(3 * static_cast<Index>(i));
  return sum;
}

Real Tissue::mass() const {
  Real sum = 0;
  for (const Real m : mass_) sum += m;
  return sum;
}

Real Tissue::kinetic_energy() const {
  Real kinetic = 0;
  for (std::size_t i = 0; i < mass_.size(); ++i)
    kinetic += 0.5 * mass_[i] * v_.segment<3>(3 * static_cast<Index>(i)).squaredNorm();
  return kinetic;
}

Real Tissue::elastic_energy() const {
  return elastic_->energy(x_);
}

bool Tissue::finite() const {
  return x_.allFinite() && v_.allFinite() && std::isfinite(at_work_);
}

BodyGeometry Tissue::geometry() const {
  const MeshData& data = mesh->data();
  BodyGeometry g;
  g.cell = BodyGeometry::Cell::tetrahedron;
  BodyGeometry::Field displacement{"displacement [m]", false, 3, {}},
      velocity{"velocity [m/s]", false, 3, {}}, held{"held", false, 1, {}},
      region{"region", true, 1, {}}, stress{"von Mises stress [Pa]", true, 1, {}},
      strain{"largest stretch", true, 1, {}};
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    const Index k = 3 * static_cast<Index>(i);
    g.points.push_back(x_.segment<3>(k));
    for (Index c = k; c < k + 3; ++c) {
      displacement.values.push_back(x_[c] - rest_[c]);
      velocity.values.push_back(v_[c]);
    }
    held.values.push_back(fixed_[i]);
  }
  for (std::size_t e = 0; e < data.tets.size(); ++e) {
    const Tet& t = data.tets[e];
    g.connectivity.insert(g.connectivity.end(), t.begin(), t.end());
    region.values.push_back(data.region[e]);
    const Mat3 F = deformation_gradient(t, data.points, x_);
    const Mat3 S = nearest_rotation(F).transpose() * F;
    const Mat3 deviator = 0.5 * (S + S.transpose()) - S.trace() / 3 * Mat3::Identity();
    stress.values.push_back(2 * tet_material_[e].lame_mu() * std::sqrt(1.5) * deviator.norm());
    strain.values.push_back(std::sqrt((F.transpose() * F).operatorNorm()));
  }
  g.fields = {std::move(displacement), std::move(velocity), std::move(held),
              std::move(region),       std::move(stress),   std::move(strain)};
  return g;
}

}  // namespace sutura
