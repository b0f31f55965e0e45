// New nodes on a moving rod: on its own cubic, with its momentum.
#pragma once

#include <functional>
#include <vector>

#include "rod.h"

namespace sutura::thread {

class Resampler {
 public:
  /// Room for rods of so many beams with the clamps and springs of this one: up to it, `apply`
  /// allocates nothing.
  void reserve(const Rod& rod, Index beams);
  /// Same rod, other nodes (ends, clamped and sprung nodes must be among them): new nodes on the
  /// cubic, with its velocity; linear and angular momentum stay as they are. `rest` and `section`
  /// give the rest pose and the section by abscissa.
  void apply(Rod& rod, const std::vector<Real>& abscissa, const std::function<Pose(Real)>& rest,
             const std::function<Section(Real)>& section);

 private:
  void plan_nodes(const Rod& rod, const std::function<Pose(Real)>& rest,
                  const std::function<Section(Real)>& section);
  void plan_twist(const Rod& rod);
  void plan_halves(const Rod& rod);
  void plan_cuts(const Rod& rod);
  void mark_neighbours(const Rod& rod);
  void rebuild(Rod& rod);
  void keep_strain(Rod& rod) const;
  void give_way(Rod& rod, Index node, Real softness) const;
  Real energy_change(const Rod& rod, Index node) const;
  void keep_momentum(Rod& rod, const Vec6& before);
  void list_concerned(const Rod& rod);

  /// Of a node within a beam that was split: what the two halves there have to keep.
  struct Whole {
    bool split = false;
    Real strain = 0;
    Real energy = 0;  ///< J
  };

  // The plan: what the rod is to be. Per node of the new rod unless said otherwise.
  RodLayout layout_;
  DofVector velocity_;
  std::vector<Real> twist_;    ///< per beam
  std::vector<char> changed_;  ///< new, or beside one that is new or goes
  std::vector<Whole> wholes_;

  // Scratch.
  std::vector<Real> old_abscissa_;
  std::vector<Index> clamped_;
  std::vector<NodeSpring> springs_;
  std::vector<RigidStretch> stretches_;
  std::vector<Index> concerned_;  ///< nodes that give momentum back
};

}  // namespace sutura::thread
