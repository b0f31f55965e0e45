// A chain of beams: its state, one implicit Euler step, and its static equilibrium. Knows no scene.
//
// Step, on the change of velocity dv (6 per node: translation, spin; world axes):
//   A dv = h (f - h K v - B v),  A = M + h B + h^2 K,  B = alpha M + beta K
// with f the exact gradient of the energy and K its positive semidefinite part (element.h).
#pragma once

#include <functional>
#include <vector>

#include "block_tridiagonal.h"
#include "dof_vector.h"
#include "element.h"
#include "sutura/body.h"

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
  DofVector velocity, force;
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
  Index newton_iterations = 1;

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
    return c == Configuration::rest ? rest_ : c == Configuration::free ? free_ : pose_;
  }
  std::vector<Pose>& state() { return pose_; }
  DofVector& velocity() { return velocity_; }
  const DofVector& velocity() const { return velocity_; }
  /// Where constraints are expected to hold the rod at the end of the next step; emptied by it.
  std::vector<Guide>& guides() { return guides_; }
  const DofVector& free_velocity() const { return free_velocity_; }
  /// Free motion less the motion that it was linearised about, whose poses are Configuration::free.
  const DofVector& free_correction() const { return free_correction_; }
  const std::vector<Real>& twist() const { return twist_; }
  std::vector<Real>& twist() { return twist_; }
  const ElementRest& element(Index e) const { return elements_[e]; }
  const Section& section(Index e) const { return sections_[e]; }
  const BlockTridiagonal& matrix() const { return matrix_; }

  /// Assembles and factors A at the current state, fills the free poses. False if it cannot.
  bool free_motion(Real dt, const Vec3& gravity);
  /// Adds dt A^-1 force to the free motion and moves to the end of the step.
  void correct(Real dt, const Dofs& force);

  // The parts of free_motion, also for measurement.
  void assemble(Real dt, const Vec3& gravity);
  bool factor();
  void advance_free(Real dt, const Vec3& gravity);

  /// Linearisations the last free motion took.
  Index passes() const { return passes_; }
  /// The last free motion found none that loses energy, and left the rod where it was.
  bool stuck() const { return stuck_; }
  /// Constraints turned a beam this many times further than a step can follow; above 1 the step was
  /// shortened.
  Real excess_turn() const { return excess_turn_; }

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
  void assemble_at(Real dt, const Vec3& gravity, const std::vector<Pose>& poses,
                   std::vector<Real>& twist, const Dofs& v, bool first);
  bool expected_motion(Real dt, const Vec3& gravity);
  void start_by_inertia(Real dt, const Vec3& gravity);
  bool guided_motion(Real dt, const Vec3& gravity);
  void apply_guides(Real dt);
  Real guide_energy() const;  ///< of their springs at the free poses
  bool find_correction(Real dt, const Vec3& gravity, Real& turn);
  void take_correction(Real dt, Real part);
  Real take_shortened(Real dt, const Vec3& gravity, Real turn, Real value);
  bool follow_guides(Real dt, const Vec3& gravity);
  bool linearise_ahead(Real dt, const Vec3& gravity);
  bool linearise_here(Real dt, const Vec3& gravity);
  void answer(const Dofs& force);
  void apply_springs(Real dt, const Vec3& fall, const std::vector<Pose>& poses, const Dofs& v,
                     bool first);
  void move(const std::vector<Pose>& from, const std::vector<Real>& twist_from, const Dofs& v,
            Real dt, std::vector<Pose>& to, std::vector<Real>& twist_to) const;
  StaticReport solve_static(const Vec3& gravity, const VecX& load, Real tolerance,
                            int max_iterations);
  /// Largest turn of a chord or tangent in the step (rad).
  Real largest_turn(const std::vector<Pose>& poses, const Dofs& step) const;
  static constexpr Real turn_limit = 0.5;  ///< rad: inside it the quadratic model of a beam is good
  Real beam_energy(Index e, const ElementState& s, const std::vector<Pose>& poses, const Dofs& v,
                   const Vec3& gravity) const;
  Real spring_energy(const std::vector<Pose>& poses) const;
  struct Energy {
    Real kinetic = 0, potential = 0;
    Real total() const { return kinetic + potential; }
  };
  /// At the free poses; `note_tension` keeps theirs for the next linearisation.
  Energy free_energy(const Vec3& gravity, bool note_tension = false);
  Real incremental_potential(Real dt, const Vec3& gravity);
  void add_correction(Real dt, Real part);
  bool descend(Real dt, const Vec3& gravity);
  void predict_tension(const std::vector<Pose>& poses, const std::vector<Real>& twist,
                       const Dofs& step, Real factor, bool first);
  void static_residual(const Vec3& gravity, const VecX& load, VecX& residual, Real& potential);

  std::vector<Real> abscissa_;
  std::vector<Section> sections_;
  std::vector<ElementRest> elements_;
  std::vector<ElementMass> masses_;
  std::vector<Pose> rest_, pose_, free_;
  std::vector<Real> twist_, free_twist_;
  std::vector<Real> tension_;  ///< of the linearisation, N
  std::vector<Guide> guides_;
  DofVector constraint_force_;  ///< of the last step: what the next one expects to feel again
  DofVector velocity_, free_velocity_, free_correction_, last_force_, rhs_, scratch_,
      before_velocity_, correction_;
  Real start_energy_ = 0;
  Real keep_ =
      1;  ///< of the velocity after the step; below 1 only when the energy balance asks for it
  Index passes_ = 0;
  bool stuck_ = false;
  static constexpr Real most_turn = 1;  ///< rad, beyond the expected motion
  Real excess_turn_ = 0;
  std::vector<Index> clamped_;
  std::vector<NodeSpring> springs_;
  BlockTridiagonal matrix_;
  ResampleWork work_;
};

/// exp(spin) applied to q.
Quat rotated(const Quat& q, const Vec3& spin);
/// The rotation vector (norm at most pi) that takes `from` to `to`, in world axes.
Vec3 rotation_between(const Quat& from, const Quat& to);

}  // namespace sutura::thread
