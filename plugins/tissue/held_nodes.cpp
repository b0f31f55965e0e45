#include "held_nodes.h"

#include <algorithm>
#include <cmath>

namespace sutura::tissue {

Index HeldNodes::fix(std::span<const Index> nodes, const void* mover) {
  mover_.resize(fixed_.size(), nullptr);
  Index contradicted = 0;
  for (const Index node : nodes) {
    const auto i = static_cast<std::size_t>(node);
    contradicted += fixed_[i] && mover_[i] != mover;
    if (!fixed_[i] || mover != nullptr) mover_[i] = mover;
    fixed_[i] = 1;
    holders_.segment<3>(3 * node).array() += 1;
  }
  return contradicted;
}

Index HeldNodes::carrier(Index fixed_node, const Vec3& at) {
  carried_.push_back({fixed_node, at});
  return static_cast<Index>(carried_.size()) - 1;
}

void HeldNodes::carry(Index carrier, const Vec3& target) {
  carried_[static_cast<std::size_t>(carrier)].target = target;
}

Index HeldNodes::support(Index node, const std::array<bool, 3>& along, const Vec3& at,
                         Real stiffness) {
  supports_.push_back({node, along, at});
  stiffness_ = stiffness;
  if (free_.size() == 0) free_.setOnes(3 * static_cast<Index>(fixed_.size()));
  for (Index k = 0; k < 3; ++k)
    if (along[static_cast<std::size_t>(k)]) {
      free_[3 * node + k] = 0;
      holders_[3 * node + k] += 1;
    }
  return static_cast<Index>(supports_.size()) - 1;
}

void HeldNodes::carry_support(Index support, const Vec3& target) {
  supports_[static_cast<std::size_t>(support)].target = target;
}

bool HeldNodes::any() const {
  return !supports_.empty() || std::find(fixed_.begin(), fixed_.end(), 1) != fixed_.end();
}

void HeldNodes::clear_fixed(VecX& nodal) const {
  for (std::size_t i = 0; i < fixed_.size(); ++i)
    if (fixed_[i]) nodal.segment<3>(3 * static_cast<Index>(i)).setZero();
}

void HeldNodes::set_velocities(const VecX& x, Real dt, VecX& v) const {
  for (const Carried& c : carried_)
    v.segment<3>(3 * c.node) = (c.target - x.segment<3>(3 * c.node)) / dt;
}

void HeldNodes::put(VecX& x) const {
  for (const Carried& c : carried_) x.segment<3>(3 * c.node) = c.target;
}

Vec3 HeldNodes::force(const Support& s, const VecX& x) const {
  Vec3 force = Vec3::Zero();
  for (Index k = 0; k < 3; ++k)
    if (s.along[static_cast<std::size_t>(k)])
      force[k] = -stiffness_ * (x[3 * s.node + k] - s.target[k]);
  return force;
}

void HeldNodes::add_force(const VecX& x, VecX& force) const {
  for (const Support& s : supports_) force.segment<3>(3 * s.node) += this->force(s, x);
}

void HeldNodes::add_stiffness(Real scale, NodeMatrix& A) const {
  for (const Support& s : supports_)
    for (Index k = 0; k < 3; ++k)
      if (s.along[static_cast<std::size_t>(k)])
        A.values()[9 * A.slot(s.node, s.node) + 4 * k] += scale * stiffness_;
}

void HeldNodes::add_stiffness(Real scale, VecX& diagonal) const {
  for (const Support& s : supports_)
    for (Index k = 0; k < 3; ++k)
      if (s.along[static_cast<std::size_t>(k)]) diagonal[3 * s.node + k] += scale * stiffness_;
}

Real HeldNodes::energy(const VecX& x) const {
  Real sum = 0;
  for (const Support& s : supports_)
    for (Index k = 0; k < 3; ++k)
      if (s.along[static_cast<std::size_t>(k)])
        sum += stiffness_ / 2 * std::pow(x[3 * s.node + k] - s.target[k], 2);
  return sum;
}

Real HeldNodes::squared_force(const VecX& x) const {
  Real sum = 0;
  for (const Support& s : supports_) sum += force(s, x).squaredNorm();
  return sum;
}

Vec3 HeldNodes::along_free(Index node, const Vec3& force) const {
  if (supports_.empty()) return force;
  return force.cwiseProduct(free_.segment<3>(3 * node));
}

}  // namespace sutura::tissue
