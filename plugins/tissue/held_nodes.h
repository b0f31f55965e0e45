// Nodes that are held from outside without being constraints. Fixed nodes are taken out of the
// equations; a fixed node may be carried to where it is told. A supported node is held by stiff
// springs along some of the axes and stays free along the others.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "block_matrix.h"

namespace sutura::tissue {

class HeldNodes {
 public:
  explicit HeldNodes(Index nodes = 0)
      : fixed_(static_cast<std::size_t>(nodes), 0), holders_(VecX::Zero(3 * nodes)) {}

  /// `mover`: what carries them, or null. Returns how many are held already, and moved otherwise.
  Index fix(std::span<const Index> nodes, const void* mover = nullptr);
  /// A fixed node that will be carried, from `at` (m). Returns the number of its carrier.
  Index carrier(Index fixed_node, const Vec3& at);
  /// Where the node is to be at the end of the step.
  void carry(Index carrier, const Vec3& target);
  /// Holds a node at `at` along the axes for which `along` is true. `stiffness` (N/m) is that of
  /// all supports. Returns the number of the support.
  Index support(Index node, const std::array<bool, 3>& along, const Vec3& at, Real stiffness);
  void carry_support(Index support, const Vec3& target);
  /// How many hold a node along each axis.
  Vec3 holders(Index node) const { return holders_.segment<3>(3 * node); }

  std::span<const char> fixed() const { return fixed_; }  ///< per node: not zero if it is
  bool is_fixed(Index node) const { return fixed_[static_cast<std::size_t>(node)] != 0; }
  bool any() const;

  /// Zero for fixed nodes. `nodal`: three numbers per node, as in all that follows.
  void clear_fixed(VecX& nodal) const;
  /// Gives carried nodes the velocity that leads from x to their targets within dt.
  void set_velocities(const VecX& x, Real dt, VecX& v) const;
  /// Puts carried nodes where they are to be.
  void put(VecX& x) const;

  /// Of the supports, with nodes at x: added to force (N).
  void add_force(const VecX& x, VecX& force) const;
  /// A += scale * their stiffness.
  void add_stiffness(Real scale, NodeMatrix& A) const;
  void add_stiffness(Real scale, VecX& diagonal) const;
  Real energy(const VecX& x) const;         ///< J
  Real squared_force(const VecX& x) const;  ///< sum over the supports (N^2)
  /// The part of a force on a node that no support takes.
  Vec3 along_free(Index node, const Vec3& force) const;

 private:
  struct Support {
    Index node = 0;
    std::array<bool, 3> along{};
    Vec3 target = Vec3::Zero();
  };
  struct Carried {
    Index node = 0;
    Vec3 target = Vec3::Zero();
  };
  Vec3 force(const Support& support, const VecX& x) const;

  std::vector<char> fixed_;
  VecX holders_;                    ///< per dof
  std::vector<const void*> mover_;  ///< per node; empty as long as none is fixed
  std::vector<Carried> carried_;
  std::vector<Support> supports_;
  VecX free_;           ///< per dof: 0 where a support holds it, else 1; empty without supports
  Real stiffness_ = 0;  ///< N/m
};

}  // namespace sutura::tissue
