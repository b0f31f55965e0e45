// What moves a tissue from outside without being a constraint: nodes that are carried, supports
// that hold some directions only, and the state it starts from.
#include <algorithm>
#include <cmath>
#include <limits>

#include "node_rotations.h"
#include "sutura/units.h"
#include "tissue.h"

namespace sutura {

Index Tissue::support(Index node, const std::array<bool, 3>& along) {
  supports_.push_back({node, along, rest_.segment<3>(3 * node)});
  // So stiff that it gives way a million times less than the tissue around the node would.
  Real young_of_all = young;
  for (const auto& [region, material] : materials_)
    young_of_all = std::max(young_of_all, material.young);
  support_stiffness_ = 1e6 * young_of_all * edge_length_;
  if (slides_.size() == 0) slides_.setOnes(dofs());
  for (Index k = 0; k < 3; ++k)
    if (along[static_cast<std::size_t>(k)]) slides_[3 * node + k] = 0;
  return static_cast<Index>(supports_.size()) - 1;
}

Index Tissue::carrier(Index fixed_node) {
  carried_.push_back({fixed_node, rest_.segment<3>(3 * fixed_node)});
  return static_cast<Index>(carried_.size()) - 1;
}

void Tissue::carry(Index carrier, const Vec3& target) {
  carried_[static_cast<std::size_t>(carrier)].target = target;
}

void Tissue::carry_support(Index support, const Vec3& target) {
  supports_[static_cast<std::size_t>(support)].target = target;
}

/// Along the directions that it holds (N).
Vec3 Tissue::support_force(const Support& s) const {
  Vec3 force = Vec3::Zero();
  for (Index k = 0; k < 3; ++k)
    if (s.along[static_cast<std::size_t>(k)])
      force[k] = -support_stiffness_ * (x_[3 * s.node + k] - s.target[k]);
  return force;
}

/// A += scale * K of the supports.
void Tissue::stiffen_supports(Real scale) {
  for (const Support& s : supports_)
    for (Index k = 0; k < 3; ++k)
      if (s.along[static_cast<std::size_t>(k)])
        A_->values()[9 * A_->slot(s.node, s.node) + 4 * k] += scale * support_stiffness_;
}

/// Beside the elastic force at x_: that of supports and loads.
void Tissue::add_outer_forces() {
  for (const Support& s : supports_) elastic_force_.segment<3>(3 * s.node) += support_force(s);
  if (load().size() == dofs()) elastic_force_ += load();
}

Vec3 Tissue::centre_of_mass() const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < mass_.size(); ++i)
    sum += mass_[i] * x_.segment<3>(3 * static_cast<Index>(i));
  return sum / mass();
}

/// Called again when a layer changes the masses, and with them their centre.
void Tissue::start_moving() {
  if (velocity.isZero(0) && spin.isZero(0)) return;
  const Vec3 centre = centre_of_mass();
  for (Index i = 0; i < dofs(); i += 3)
    v_.segment<3>(i) = velocity + spin.cross(x_.segment<3>(i) - centre);
}

/// Newton on the potential of elasticity, supports, weight and loads, each step shortened until the
/// potential falls. With a solver of its own: the one of the steps may be late by some of them.
std::string Tissue::settle(const Vec3& gravity) {
  const bool any_fixed = std::find(fixed_.begin(), fixed_.end(), 1) != fixed_.end();
  if (!any_fixed && supports_.empty())
    return "nothing holds this tissue, so it has no balance; it needs an Attach";
  VecX weight(dofs());
  for (Index i = 0; i < dofs(); i += 3)
    weight.segment<3>(i) = mass_[static_cast<std::size_t>(i / 3)] * gravity;
  const VecX outside = load().size() == dofs() ? VecX(weight + load()) : weight;
  for (const Carried& c : carried_) x_.segment<3>(3 * c.node) = c.target;
  v_.setZero();
  const auto potential = [&](const VecX& x) {
    Real sum = elastic_->energy(x) - outside.dot(x - rest_);
    for (const Support& s : supports_)
      for (Index k = 0; k < 3; ++k)
        if (s.along[static_cast<std::size_t>(k)])
          sum += support_stiffness_ / 2 * std::pow(x[3 * s.node + k] - s.target[k], 2);
    return sum;
  };
  const auto direct = make_direct_solver();
  direct->analyse(A_->pattern(), fixed_, {});
  // Newton halves what is missing in a few steps, or in a few more where the tissue buckles on the
  // way. Under a load that has no balance it would go on for ever.
  constexpr Index most = 200, patience = 30;
  // A millionth of what acts, or nothing left to move: the forces of stiff supports never add up to
  // less than their rounding.
  const Real tolerance = 1e-6 * outside.norm(), smallest = 1e-9 * edge_length_;
  bool found = false;
  VecX next_x;
  Real value = potential(x_), left = 0, half = std::numeric_limits<Real>::infinity();
  Index halved = 0;  // the last step in which it was
  for (Index i = 0; i < most; ++i) {
    A_->set_zero();
    elastic_force_ = weight;
    elastic_->linearise(x_, 1, *A_, elastic_force_);
    stiffen_supports(1);
    add_outer_forces();
    for (std::size_t k = 0; k < fixed_.size(); ++k)
      if (fixed_[k]) elastic_force_.segment<3>(3 * static_cast<Index>(k)).setZero();
    left = elastic_force_.norm();
    found = left <= tolerance;
    if (left < half) {
      half = left / 2;
      halved = i;
    }
    if (found || i - halved > patience || !std::isfinite(left)) break;
    node_rotations(mesh->data(), x_, node_rotations_);
    direct->prepare(*A_, node_rotations_, i);
    rhs_ = elastic_force_;
    direct->solve(rhs_);
    found = rhs_.lpNorm<Eigen::Infinity>() <= smallest;
    if (found) break;
    Real part = 1;
    for (int cut = 0; cut < 30; ++cut, part /= 2) {
      next_x = x_ + part * rhs_;
      const Real next = potential(next_x);
      // The last steps change the potential by less than its rounding.
      if (!(next < value) && part * rhs_.lpNorm<Eigen::Infinity>() > 1e-6 * edge_length_) continue;
      value = next;
      break;
    }
    x_ = next_x;
  }
  move_queries(Configuration::current, x_);
  assembled_for_ = 0;  // the factor that is there is of another shape
  if (found) return {};
  return "no balance was found, " + format_real(left) + " N of " + format_real(outside.norm()) +
         " N are left";
}

}  // namespace sutura
