// What moves a tissue from outside without being a constraint: nodes that are carried, supports
// that hold some directions only, and the state it starts from.
#include <algorithm>
#include <cmath>

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
  return static_cast<Index>(supports_.size()) - 1;
}

Index Tissue::carrier(Index fixed_node) {
  carried_.push_back({fixed_node, rest_.segment<3>(3 * fixed_node), Vec3::Zero()});
  return static_cast<Index>(carried_.size()) - 1;
}

void Tissue::carry(Index carrier, const Vec3& target) {
  carried_[static_cast<std::size_t>(carrier)].target = target;
}

void Tissue::carry_support(Index support, const Vec3& target) {
  supports_[static_cast<std::size_t>(support)].target = target;
}

/// A fixed node keeps the velocity that it has: so it is given the one that leads to its target.
void Tissue::carry_fixed_nodes(Real h) {
  for (Carried& c : carried_) {
    const Vec3 v = (c.target - x_.segment<3>(3 * c.node)) / h;
    c.push = mass_[static_cast<std::size_t>(c.node)] / h * (v - v_.segment<3>(3 * c.node));
    v_.segment<3>(3 * c.node) = v;
  }
}

/// As one more elastic force with its stiffness, at x_free_.
void Tissue::add_supports(Real scale) {
  for (const Support& s : supports_) {
    Real* block = A_->values() + 9 * A_->slot(s.node, s.node);
    for (Index k = 0; k < 3; ++k) {
      if (!s.along[static_cast<std::size_t>(k)]) continue;
      block[4 * k] += scale * support_stiffness_;
      elastic_force_[3 * s.node + k] -= support_stiffness_ * (x_free_[3 * s.node + k] - s.target[k]);
    }
  }
}

/// After the step: what supports and carried nodes add to the reactions of fixed ones.
void Tissue::note_support_reactions() {
  for (const Carried& c : carried_) reaction_.segment<3>(3 * c.node) += c.push;
  for (const Support& s : supports_)
    for (Index k = 0; k < 3; ++k)
      if (s.along[static_cast<std::size_t>(k)])
        reaction_[3 * s.node + k] = -support_stiffness_ * (x_[3 * s.node + k] - s.target[k]);
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

void Tissue::move_queries() {
  x_free_ = x_;
  for (const Configuration c : {Configuration::current, Configuration::free})
    queries_[static_cast<std::size_t>(c)].move(c == Configuration::current ? x_ : x_free_);
}

/// Newton on the potential of elasticity, supports, weight and loads, each step shortened until the
/// potential falls. With a solver of its own: the one of the steps may be late by some of them.
std::string Tissue::settle(const Vec3& gravity) {
  if (!any_fixed_ && supports_.empty())
    return "nothing holds this tissue, so it has no balance; it needs an Attach";
  if (!started_) start();
  VecX outside = load().size() == dofs() ? load() : VecX(VecX::Zero(dofs()));
  for (Index i = 0; i < dofs(); i += 3)
    outside.segment<3>(i) += mass_[static_cast<std::size_t>(i / 3)] * gravity;
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
  constexpr Index most = 200;
  // A millionth of what acts, or nothing left to move: the forces of stiff supports never add up to
  // less than their rounding.
  const Real tolerance = 1e-6 * outside.norm(), smallest = 1e-9 * edge_length_;
  bool found = false;
  Real value = potential(x_), left = 0;
  for (Index i = 0; i < most; ++i) {
    x_free_ = x_;
    A_->set_zero();
    elastic_force_ = outside;
    elastic_->linearise(x_free_, 1, *A_, elastic_force_);
    add_supports(1);
    for (std::size_t k = 0; k < fixed_.size(); ++k)
      if (fixed_[k]) elastic_force_.segment<3>(3 * static_cast<Index>(k)).setZero();
    left = elastic_force_.norm();
    found = left <= tolerance;
    if (found) break;
    update_node_rotations();
    direct->prepare(*A_, node_rotations_, i);
    rhs_ = elastic_force_;
    direct->solve(rhs_);
    found = rhs_.lpNorm<Eigen::Infinity>() <= smallest;
    if (found) break;
    Real part = 1;
    for (int cut = 0; cut < 30; ++cut, part /= 2) {
      x_free_ = x_ + part * rhs_;
      const Real next = potential(x_free_);
      // The last steps change the potential by less than its rounding.
      if (!(next < value) && part * rhs_.lpNorm<Eigen::Infinity>() > 1e-6 * edge_length_) continue;
      value = next;
      break;
    }
    x_ = x_free_;
  }
  move_queries();
  if (found) return {};
  return "no balance was found, " + format_real(left) + " N of " + format_real(outside.norm()) +
         " N are left";
}

}  // namespace sutura
