// A chain of beams: its state, one implicit Euler step, and its static equilibrium. Knows no scene.
//
// A step is implicit Euler, solved in passes. At the guess v of the velocity at its end (6 per
// node: translation, spin; world axes), with the poses x = start + h v,
//   r = M (v_start - v) + h (f(x) + weight - B v),     A dv = r,     A = M + h B + h^2 K,  B =
//   alpha M + beta K
// (B v: the drag alpha M v and the viscous force of viscosity.h),
// with f the exact gradient of the energy and K its Hessian, or a convex part of it where A would
// not be positive definite (element.h). The geometric stiffness in K takes the tension that the
// pass before predicted and not the one at the guess: a stiff beam that turns by theta in a pass is
// stretched by theta^2/2 until the next pass takes that back (docs/theory/thread.md).
#pragma once

#include <functional>
#include <vector>

#include "block_tridiagonal.h"
#include "dof_vector.h"
#include "element.h"
#include "element_mass.h"
#include "sutura/body.h"
#include "viscosity.h"

namespace sutura::thread {

/// Where the nodes are along the rest curve, and what lies between them.
struct RodLayout {
  std::vector<Real> abscissa;     ///< nodes, ascending, m
  std::vector<Pose> rest;         ///< section poses at rest, x axis = tangent
  std::vector<Pose> start;        ///< section poses at the beginning
  std::vector<Section> sections;  ///< one per beam
};

/// A section tied to a pose by a spring (Hold of a grasper).
struct NodeSpring {
  Index node = 0;
  bool active = false;
  Pose target;
  HoldStiffness stiffness;
  Wrench applied;  ///< on the rod, at the end of the last step
};

/// Work space of Rod::resample, kept so that it allocates nothing. Per node of the new rod unless
/// said otherwise.
struct ResampleWork {
  RodLayout layout;
  DofVector velocity;
  std::vector<Real> twist, strain, old_abscissa;
  std::vector<char> changed, halves;
  std::vector<Index> clamped, concerned;
  std::vector<NodeSpring> springs;
  void reserve(std::size_t nodes);
};

class Rod {
 public:
  // Settings.
  Real damping_mass = 0;       ///< alpha, 1/s
  Real damping_stiffness = 0;  ///< beta, s

  void build(const RodLayout& layout);
  /// Room for so many beams: up to it, resample allocates nothing. After the clamps and springs.
  void reserve(Index beams);
  /// Same rod, other nodes (ends, clamped and sprung nodes must be among them): new nodes on the
  /// cubic, with its velocity; linear and angular momentum stay as they are. `rest` and `section`
  /// give the rest pose and the section by abscissa.
  void resample(const std::vector<Real>& abscissa, const std::function<Pose(Real)>& rest,
                const std::function<Section(Real)>& section);
  /// State and holds; the layout must be the one that was saved.
  void archive(Archive& archive);
  /// All six dofs of the node stay as they are.
  void clamp(Index node);
  const std::vector<Index>& clamped() const { return clamped_; }
  std::vector<NodeSpring>& springs() { return springs_; }
  const std::vector<NodeSpring>& springs() const { return springs_; }

  Index nodes() const { return static_cast<Index>(pose_.size()); }
  Index beams() const { return nodes() - 1; }
  Index dofs() const { return 6 * nodes(); }
  const std::vector<Real>& abscissa() const { return abscissa_; }
  const std::vector<Pose>& poses(Configuration c) const {
    return c == Configuration::rest ? rest_ : c == Configuration::start ? start_ : pose_;
  }
  std::vector<Pose>& state() { return pose_; }
  DofVector& velocity() { return velocity_; }
  const DofVector& velocity() const { return velocity_; }
  /// Dead loads of the steps to come (N, N m; 6 per node), or empty: none.
  void set_load(const VecX& load);
  /// Change of the guess, in velocity, that answers what is missing of balance.
  const DofVector& change() const { return change_; }
  const std::vector<Real>& twist() const { return twist_; }
  std::vector<Real>& twist() { return twist_; }
  const ElementRest& element(Index e) const { return elements_[e]; }
  const Section& section(Index e) const { return sections_[e]; }
  const BlockTridiagonal& matrix() const { return matrix_; }

  /// Begins a step where the last one ended, or the same step anew with another length.
  void begin_step(Real dt, const Vec3& gravity);
  /// Assembles and factors A at the guess and finds the change under `force` of constraints. False
  /// if A is not positive definite.
  bool linearise(const Dofs& force);
  /// The guess moves by that change and the answer to a change of force; only part of the way where
  /// that turns a beam too far.
  void correct(const Dofs& force_change);
  /// Of the guess under `force` of constraints.
  Imbalance imbalance(const Dofs& force) const;
  /// A balanced guess that is no minimum of the potential moves on to where that is lower. False if
  /// it is a minimum, or if constraints push the rod: they may hold it there.
  bool leave_saddle();
  /// The guess is the end of the step, which had this force of constraints.
  void end_step(const Dofs& force);
  /// A whole step under `force` alone, in passes until its relative imbalance is below `tolerance`.
  /// Returns the passes, 0 if they did not get there.
  Index advance(Real dt, const Vec3& gravity, const Dofs& force, Real tolerance = 1e-9);

  // The parts of linearise, also for measurement.
  /// exact: the Hessian, which may be indefinite; convex: its positive semidefinite part
  /// (element.h).
  enum class Tangent { exact, convex };
  void assemble(Tangent tangent);
  /// Factors what `assemble` made; false if that is not positive definite.
  bool factor();
  /// The incremental potential at the guess (J): the step ends at its minimum.
  Real potential() const;
  /// The momentum missing at the guess without constraints (N s, N m s; 6 per node): dt times the
  /// derivative of the potential by the motion, with the sign changed.
  const DofVector& missing() const { return missing_; }
  /// From the start of the step to the guess: shift and turn of every node (see `turned`; m, rad; 6
  /// per node).
  const DofVector& motion() const { return motion_; }
  /// Another guess.
  void guess(const VecX& motion);

  struct StaticReport {
    bool converged = false;
    int iterations = 0;
    Real residual = 0;  ///< N, largest force (moments divided by the mean beam length)
  };
  /// Static equilibrium under gravity and dead nodal loads (force, moment; 6 per node) by Newton
  /// with the full tangent, in 20 load steps where one is too many. Holds act as springs. Velocity
  /// becomes zero.
  StaticReport equilibrium(const Vec3& gravity, const VecX& load, Real tolerance = 1e-10,
                           int max_iterations = 200);

  /// The full static tangent at the current state (clamps applied); `tension` replaces that of the
  /// beams.
  void assemble_tangent(const Vec3& gravity, BlockTridiagonal& matrix,
                        const std::vector<Real>* tension = nullptr) const;

  Real mass() const;
  /// Memory of one step's working set, bytes.
  std::size_t bytes() const;
  Real elastic_energy() const;
  Real kinetic_energy() const;
  Vec3 momentum() const;
  Vec3 angular_momentum() const;  ///< about the origin
  bool finite() const;
  /// State of one beam in the current configuration.
  void element_state(Index e, ElementState& s) const;

 private:
  void aim();
  void go_on(Real part);
  bool goes_straight(Index node) const;
  void take_motion();
  void add_turning_moments();
  Vec3 lever(Index node) const;
  void evaluate_guess();
  bool buckles();
  void add_beam_balance(Index e);
  DeformationChange deformed(Index e) const;
  void add_spring_balance();
  Wrench spring_wrench(const NodeSpring& spring) const;
  void move(const std::vector<Pose>& from, const std::vector<Real>& twist_from, const Dofs& motion,
            std::vector<Pose>& to, std::vector<Real>& twist_to) const;
  StaticReport solve_static(const Vec3& gravity, const VecX& load, Real tolerance,
                            int max_iterations);
  /// Largest turn of a chord or tangent in the step (rad).
  Real largest_turn(const std::vector<Pose>& poses, const Dofs& step) const;
  static constexpr Real turn_limit = 0.5;  ///< rad: inside it the quadratic model of a beam is good
  /// Forces below this share of the largest in the rod are taken for rounding where nothing else is
  /// at work.
  static constexpr Real negligible = 1e-6;
  void predict_tension(Real part);
  void static_residual(const Vec3& gravity, const VecX& load, VecX& residual, Real& potential);

  std::vector<Real> abscissa_;
  std::vector<Section> sections_;
  std::vector<ElementRest> elements_;
  std::vector<ElementMass> masses_;
  std::vector<Pose> rest_, pose_;
  std::vector<Real> twist_;
  DofVector velocity_, load_;

  // The step: where it began, and what is known at the guess.
  bool in_step_ = false;
  bool pushed_ = false;  ///< by constraints, in the last step
  Real dt_ = 0;
  Vec3 gravity_ = Vec3::Zero();
  std::vector<Pose> start_;
  std::vector<Real> start_twist_;
  std::vector<Deformation> start_deformation_;  ///< per beam, where it has viscosity
  DofVector start_velocity_;
  DofVector motion_;
  std::vector<Vec3> start_rate_;      ///< of the tangents, 1/s
  std::vector<ElementState> states_;  ///< per beam
  std::vector<Real> tension_;         ///< that the last pass predicted, N
  DofVector missing_;          ///< r: momentum due at the guess, without constraint forces (N s)
  std::vector<Real> at_work_;  ///< per node: sum of the sizes of the forces on it (N)
  DofVector change_, answer_, from_, force_;  ///< force_: of constraints, on the guess (N, N m)
  std::vector<Vec3> chord_, drift_;           ///< of aim and go_on: per beam, per node (m)
  std::vector<Real> strain_, strain_change_;  ///< of aim, per beam
  std::vector<Vec3> lever_;                   ///< per node, under the forces of the last pass (N m)
  std::vector<Real> axial_moment_;            ///< likewise, about the tangent (N m)
  Index straight_places_ = 0;                 ///< of aim: nodes that go straight on
  Real last_turn_ = 0;                        ///< that the pass before asked of a beam (rad)
  bool stuck_ = false;                        ///< less than a tenth of the last pass could be taken
  std::vector<Index> clamped_;
  std::vector<NodeSpring> springs_;
  BlockTridiagonal matrix_;
  ResampleWork work_;
};

/// exp(spin) applied to q.
Quat rotated(const Quat& q, const Vec3& spin);
/// A section that first rolls about its tangent (x axis) by the part of `turn` along it, then tilts
/// by the part across it (rad). Unlike a rotation vector, roll and tilt do not mix, whatever the
/// number of turns that the section rolls.
Quat turned(const Quat& q, const Vec3& turn);
inline Vec3 tangent(const Pose& section) {
  return section.rotation * Vec3::UnitX();
}
/// The rotation vector (norm at most pi) that takes `from` to `to`, in world axes.
Vec3 rotation_between(const Quat& from, const Quat& to);

}  // namespace sutura::thread
