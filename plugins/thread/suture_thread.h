// SutureThread: needle and thread as one chain of beams.
#pragma once

#include "chain_compliance.h"
#include "curve.h"
#include "held_strands.h"
#include "needle_pose.h"
#include "resampler.h"
#include "rod.h"
#include "rod_step.h"
#include "sampling.h"
#include "sutura/body.h"
#include "sutura/cuttable.h"
#include "sutura/describe.h"
#include "suture_shape.h"

namespace sutura::thread {

class SutureThread : public Component,
                     public SegmentedCurve,
                     public Cuttable,
                     public RigidStretches {
 public:
  static constexpr const char* interface_name = "SutureThread";
  enum class Clamp { none, start, end, both };

  // Attributes; each is explained in describe().
  Real needle_arc_length = 26e-3, needle_angle = std::numbers::pi, needle_diameter = 0.65e-3;
  Real needle_young = 190e9, needle_poisson = 0.3, needle_density = 7850;
  Real thread_length = 0.3, thread_diameter = 0.175e-3;
  Real thread_young = 1.5e9, thread_poisson = 0.4, thread_density = 910, bending_factor = 1;
  Real thread_bend_radius = 5e-3, thread_rest_curvature = 0, thread_rest_torsion = 0;
  File thread_rest_file, thread_start_file;
  std::string needle, thread;
  Real sampling_angle = 0, shortest_beam = 0.5e-3;
  Index needle_beams = 12, thread_beams = 100, newton_iterations = 1;
  Vec3 tip = Vec3::Zero(), tip_direction = Vec3::UnitX(), plane_normal = Vec3::UnitZ();
  Vec3 thread_direction = Vec3::Zero();
  Vec3 needle_centre = Vec3::Zero(), entry = Vec3::Zero();
  Real tip_angle = 0, approach = 0;
  Vec3 velocity = Vec3::Zero(), spin = Vec3::Zero();
  bool settles = false;
  Real damping_mass = 0, damping_stiffness = 0, strength = 0;
  Clamp clamp = Clamp::none;
  static void describe(Describe<SutureThread>& d);

  void initialise(Setup& setup) override;
  void ready(Setup& setup) override;
  void archive(Archive& archive) override;

  // Body
  Index dofs() const override { return rod_.dofs(); }
  int width() const override { return 6; }
  bool wants_settling() const override { return settles; }
  std::string settle(const Vec3& gravity) override;
  void begin_step(const StepContext& context) override;
  void linearise(const StepContext& context, const VecX& force) override;
  Eigen::Ref<const VecX> change() const override { return step_.change(); }
  void solve(Eigen::Ref<MatX> columns) const override;
  void add_compliance(const BodyRows& rows, Real dt, Eigen::Ref<MatX> W) const override;
  void push(const StepContext& context, const VecX& force_change) override;
  void correct(const StepContext& context) override;
  bool went_part_way() const override { return step_.went_part_way(); }
  void motion(VecX& out) const override { out = step_.guess().motion; }
  void move_to(const StepContext&, const VecX& motion) override {
    factored_ = true;  // what could not be factored was another guess
    step_.move_to(rod_, motion);
  }
  Imbalance imbalance(const StepContext& context, const VecX& force) override;
  Real time_error(const StepContext&) const override { return step_.time_error(rod_); }
  Index least_passes() const override { return newton_iterations; }
  bool leave_saddle() override;
  bool goes_on_as_before(const StepContext&) override;
  void end_step(const StepContext& context, const VecX& force) override;
  Vec3 momentum() const override { return rod_.momentum(); }
  Real mass() const override { return rod_.mass(); }
  Vec3 centre_of_mass() const override;
  Real energy() const override { return rod_.kinetic_energy() + rod_.elastic_energy(); }
  Real power(const VecX& force) const override { return force.dot(rod_.velocity()); }
  Real held_power() const override;
  bool finite() const override { return factored_ && rod_.finite(); }
  std::string trouble() const override;
  std::string fault() const override;
  bool tells_when() const override;
  BodyGeometry geometry() const override;

  // CurveBody
  Real length() const override { return shape_.length(); }
  Real needle_length() const override { return shape_.needle_length; }
  Real radius(Real s) const override;
  Vec3 point(Real s, Configuration c) const override { return curve_point(rod_, s, c); }
  void jacobian(Real s, PointJacobian& out) const override {
    curve_jacobian(rod_, s, Configuration::current, out);
  }
  Vec3 tangent(Real s, Configuration c) const override { return curve_tangent(rod_, s, c); }
  Real tension(Real s) const override { return section_state(s).tension; }
  Pose frame(Real s, Configuration c) const override { return curve_frame(rod_, s, c); }
  Real closest_abscissa(const Vec3& p, Real guess, Real low, Real high,
                        Configuration c) const override {
    return curve_closest(rod_, p, guess, low, high, c);
  }
  void segments(Configuration c, std::vector<CurveSegment>& out) const override {
    curve_segments(rod_, c, out);
  }
  void surface_jacobian(Real s, const Vec3& arm, PointJacobian& out) const override {
    curve_surface_jacobian(rod_, s, arm, out);
  }
  Real coarse_roll(Real s) const override {
    return coarse_curve_roll(rod_, s, step_.guess().motion);
  }
  Index add_hold(Real s) override;
  void set_hold(Index hold, const Pose& target, const HoldStiffness& stiffness) override;
  void release_hold(Index hold) override;
  Wrench hold_wrench(Index hold) const override;

  // Cuttable
  void cut(Real s) override;

  // RigidStretches
  std::optional<std::pair<Real, Real>> rigid_range(Real from, Real to) const override;
  void make_rigid(Index body, Real from, Real to) override;
  void release(Index body) override;
  bool is_rigid(Index body) const override;
  Wrench end_wrench(Real s, bool of_the_one_before) const override;

  /// To the load of the step: on the section of a hold, which need not be closed.
  void add_load(Index hold, const Wrench& wrench);
  /// What a limit of stretch bears on a beam at the present guess, beside the elastic thread (N).
  void set_limit_tension(Index beam, Real tension) { step_.set_limit_tension(beam, tension); }
  /// Of the beam at s: mean curvature (1/m), twist per length (rad/m), axial force (N) and the
  /// whole force (N) with which what follows draws what comes before: along the beam and across it.
  struct SectionState {
    Real curvature = 0, twist = 0, tension = 0;
    Vec3 force = Vec3::Zero();
  };
  SectionState section_state(Real s) const;

  const Rod& rod() const { return rod_; }
  Real largest_strain() const;
  Real largest_curvature() const;

 private:
  void look_up_products(Setup& setup);
  TipPlace place_needle() const;
  RestShape read_rest(Setup& setup);
  RestShape read_shape(Setup& setup, const char* attribute, const File& file);
  void start_moving();
  void build();
  void sample_start();
  std::string coarse_bend() const;
  void lay_out(std::vector<Real> nodes);
  void doubt_sizes(Setup& setup) const;
  std::vector<Real> node_abscissae() const;
  Section section(Real s) const;
  Real drawn_radius(Real s) const;
  void resample();
  Real tension_of(Index beam, const ElementState& state) const;
  Real limit_tension(Index beam) const;
  void keep_limits();
  struct Taut {
    Index beam = -1;
    Real tension = 0;  // N
  };
  Taut most_taut() const;
  void tear();
  void release_beam(Index beam);
  Real middle(Index beam) const;
  void place_nodes(const std::vector<Real>& abscissae);
  void split(Index beam);
  Index node_at(Real s) const;

  Rod rod_;
  RodStep step_;
  HeldStrands held_strands_;
  Resampler resampler_;
  SutureShape shape_;
  /// Between these abscissae a limit of stretch bears so much (N).
  struct LimitTension {
    Real from = 0, to = 0, tension = 0;
  };
  std::vector<LimitTension> limits_;  ///< at the end of the last step
  SamplingRules rules_;
  SamplingWork sampling_work_;
  Real sampling_change_ = 0;  ///< of elastic energy, by the last step's event, to all energy
  Real torn_late_ = 0;        ///< with how much it bore, in the last step (N); 0: not
  std::vector<Real> holds_;   ///< abscissae
  mutable ChainCompliance compliance_;
  mutable BodyRows led_rows_;  ///< of the chain without followers
  mutable std::vector<Index> led_clamps_;
  bool factored_ = true;
};

}  // namespace sutura::thread
