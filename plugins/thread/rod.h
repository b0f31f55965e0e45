// A chain of beams as it is at one time: nodes, beams, and what holds it. Knows no scene.
//
// What happens to it has files of its own: the time step (rod_step.h), balance at rest
// (rod_static.h), other nodes (resampler.h), points of its curve (curve.h).
#pragma once

#include <vector>

#include "chain_motion.h"
#include "dof_vector.h"
#include "element.h"
#include "stretches.h"
#include "sutura/body.h"

namespace sutura::thread {

/// Where the nodes are along the rest curve, and what lies between them.
struct RodLayout {
  std::vector<Real> abscissa;     ///< nodes, ascending, m
  std::vector<Pose> rest;         ///< section poses at rest, x axis = tangent
  std::vector<Pose> start;        ///< section poses at the beginning
  std::vector<Section> sections;  ///< one per beam
  std::vector<Index> cut = {};    ///< beams that bear nothing, ascending
};

/// A section tied to a pose by a spring (Hold of a grasper). The turn from the section to the
/// target is a tilt, the shortest from tangent to tangent, and a roll about them, counted over
/// whole turns.
struct NodeSpring {
  Index node = 0;
  bool active = false;
  Pose target;
  Vec3 last_target = Vec3::Zero();  ///< where that was at the end of the last step
  HoldStiffness stiffness;
  Real roll = 0;   ///< at the end of the last step (rad)
  Wrench applied;  ///< on the rod, at the end of the last step

  /// The roll when the section, which began the step as `start`, has turned by `motion` since then
  /// (see `turned`; rad). The target turns by less than half a turn in a step.
  Real roll_at(const Quat& start, const Vec3& motion) const;
  /// On a section with that pose and roll: minus the derivative of the energy.
  Wrench wrench(const Pose& section, Real roll) const;
  Real energy(const Pose& section, Real roll) const;
  /// Likewise, where the roll is within half a turn of that at the end of the last step.
  Wrench wrench(const Pose& section) const;

 private:
  Real counted(Real roll) const;
};

class Rod {
 public:
  /// At rest as the layout says, without clamps and springs.
  void build(const RodLayout& layout);
  /// Room for so many beams: up to it, `build` allocates nothing.
  void reserve(Index beams);
  /// State and holds; the layout must be the one that was saved.
  void archive(Archive& archive);

  Index nodes() const { return static_cast<Index>(pose_.size()); }
  Index beams() const { return nodes() - 1; }
  Index dofs() const { return 6 * nodes(); }

  // What it is made of.
  const std::vector<Real>& abscissa() const { return abscissa_; }
  const Section& section(Index beam) const { return sections_[beam]; }
  const ElementRest& element(Index beam) const { return elements_[beam]; }
  const ElementMass& inertia(Index beam) const { return masses_[beam]; }

  // How it is: poses and twist (rad; of a beam, counted beyond a turn), velocity (m/s, rad/s; 6 per
  // node).
  const std::vector<Pose>& poses(Configuration c) const {
    return c == Configuration::rest ? rest_ : c == Configuration::start ? start_ : pose_;
  }
  std::vector<Pose>& poses() { return pose_; }
  const std::vector<Pose>& poses() const { return pose_; }
  std::vector<Real>& twist() { return twist_; }
  const std::vector<Real>& twist() const { return twist_; }
  DofVector& velocity() { return velocity_; }
  const DofVector& velocity() const { return velocity_; }
  /// The beam bears nothing from now on; half of its mass stays with each of its ends. Linear
  /// momentum stays as it is.
  void cut(Index beam);
  bool is_cut(Index beam) const { return cut_[static_cast<std::size_t>(beam)] != 0; }
  Index cuts() const;
  /// Nodes first .. last move as one body from now on, whatever acts on them, and the beams between
  /// them keep the shape and the forces that they have.
  void make_rigid(const RigidStretch& stretch) { stretches_.add(stretch); }
  /// The stretches of that body; false if there is none.
  bool release(Index body) { return stretches_.remove(body); }
  const Stretches& stretches() const { return stretches_; }
  /// A step begins at the present poses.
  void mark_start() { start_ = pose_; }

  // What holds it.
  /// All six dofs of the node stay as they are.
  void clamp(Index node) { clamped_.push_back(node); }
  const std::vector<Index>& clamped() const { return clamped_; }
  bool is_clamped(Index node) const;
  std::vector<NodeSpring>& springs() { return springs_; }
  const std::vector<NodeSpring>& springs() const { return springs_; }
  bool is_held() const;            ///< by a clamp or a spring
  bool is_held(Index node) const;  ///< likewise, there

  // What follows.
  void element_state(Index beam, ElementState& s) const;
  Real mass() const;
  Real elastic_energy() const;
  Real kinetic_energy() const;
  Vec3 momentum() const;
  Vec3 angular_momentum() const;  ///< about the origin
  bool finite() const;

 private:
  /// Constants of the beam, as its section and `cut_` say.
  void renew(Index beam);

  std::vector<Real> abscissa_;
  std::vector<Section> sections_;
  std::vector<ElementRest> elements_;
  std::vector<ElementMass> masses_;
  std::vector<Pose> rest_, start_, pose_;
  std::vector<Real> twist_;
  std::vector<Index> cut_;  ///< per beam, 1 where it is cut
  DofVector velocity_;
  std::vector<Index> clamped_;
  std::vector<NodeSpring> springs_;
  Stretches stretches_;
};

}  // namespace sutura::thread
