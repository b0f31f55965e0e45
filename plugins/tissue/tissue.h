// <Tissue young="30 kPa" poisson="0.45"/>: a soft solid made of tetrahedra, implicit Euler.
// Equations: docs/theory/tissue.md.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "self_overlap.h"
#include "solid_queries.h"
#include "sutura/component.h"
#include "sutura/describe.h"
#include "sutura/end_note.h"
#include "tet_mesh.h"
#include "tissue_fields.h"
#include "tissue_model.h"
#include "tissue_solver.h"
#include "tissue_step.h"

namespace sutura::tissue {

/// unstated: t4, with a warning where it is too stiff. t4: corotational linear tets. smoothed: the
/// same tets, cured of locking (smoothed_t4.h).
enum class TissueElement { unstated, t4, smoothed };

class Tissue : public Component, public MeshedSolid, public EndNote {
 public:
  static constexpr const char* interface_name = "Tissue";

  Real young = 3e3;
  Real poisson = 0.45;
  Real density = 1000;
  Real damping_mass = 0;
  Real damping_stiffness = 0;
  TissueElement element = TissueElement::unstated;
  Index iterations = 1;
  Vec3 velocity = Vec3::Zero(), spin = Vec3::Zero();
  bool settles = false;
  Link<TetMesh> mesh;
  Link<TissueSolver> solver;

  static void describe(Describe<Tissue>& d);
  void initialise(Setup& setup) override;
  void ready(Setup& setup) override;
  void archive(Archive& archive) override;

  // For the components that complete a tissue, from their initialise.
  /// False if the region already has a material of its own.
  bool set_material(int region, const Material& material);
  /// As HeldNodes::support, of a node where it is at rest; so stiff that it gives way a million
  /// times less than the tissue around the node would.
  Index support(Index node, const std::array<bool, 3>& along);
  /// Kept by reference.
  void add_follower(FollowerLoad& follower) { model_.followers.push_back(&follower); }
  TissueModel& model() { return model_; }
  const TissueModel& model() const { return model_; }

  /// Force (N) with which an attachment holds these nodes, over the last step. Of a node that
  /// several hold along an axis it is an equal share; zero for free ones.
  Vec3 reaction(const std::vector<Index>& nodes) const;
  Index inverted() const { return inverted_tets(model_, step_->positions()); }
  const VecX& positions() const { return step_->positions(); }    ///< m, node by node
  const VecX& velocities() const { return step_->velocities(); }  ///< m/s
  /// For restarts and tests. Fixed nodes are fixed where they are put; their velocity becomes zero.
  void set_state(const VecX& x, const VecX& v);
  const TissueSolveReport& solve_report() const { return solver_->report(); }

  // Body
  Index dofs() const override { return model_.dofs(); }
  int width() const override { return 3; }
  bool wants_settling() const override { return settles; }
  std::string settle(const Vec3& gravity) override;
  void begin_step(const StepContext& context) override;
  void linearise(const StepContext& context, const VecX& force) override {
    step_->linearise(context, force);
  }
  Eigen::Ref<const VecX> change() const override { return step_->change(); }
  void solve(Eigen::Ref<MatX> columns) const override { solver_->solve(columns); }
  void add_compliance(const BodyRows& rows, Real dt, Eigen::Ref<MatX> W) const override {
    add_tissue_compliance(*solver_, rows, dt, W);
  }
  void push(const StepContext& context, const VecX& force_change) override;
  void correct(const StepContext& context) override;
  void motion(VecX& out) const override;
  void move_to(const StepContext& context, const VecX& motion) override;
  Imbalance imbalance(const StepContext& context, const VecX& force) override {
    return step_->imbalance(context, force);
  }
  Real time_error(const StepContext& context) const override { return step_->time_error(context); }
  Index least_passes() const override { return iterations; }
  void end_step(const StepContext& context, const VecX& force) override;
  Vec3 momentum() const override { return tissue::momentum(model_, velocities()); }
  Real mass() const override { return sum(model_.mass); }
  Vec3 centre_of_mass() const override { return tissue::centre_of_mass(model_, positions()); }
  Real energy() const override { return kinetic_energy() + elastic_energy(); }
  Real kinetic_energy() const { return tissue::kinetic_energy(model_, velocities()); }  ///< J
  Real elastic_energy() const { return model_.elastic->energy(positions()); }           ///< J
  Real power(const VecX& force) const override { return force.dot(velocities()); }
  Real held_power() const override { return step_->reaction().dot(velocities()); }
  bool finite() const override { return step_->finite(); }
  std::string trouble() const override { return step_->trouble(); }
  std::string fault() const override;
  std::string end_note() const override { return overlap_.sentence(model_.edge_length); }
  BodyGeometry geometry() const override {
    return tissue::geometry(model_, positions(), velocities());
  }

  // SolidBody
  Vec3 position(const EmbeddedPoint& p, Configuration c) const override;
  void jacobian(const EmbeddedPoint& p, PointJacobian& out) const override;
  std::optional<EmbeddedPoint> locate(const Vec3& p, Configuration c) const override;
  std::optional<SurfacePoint> closest_surface(const Vec3& p, Real reach, Configuration c,
                                              const Vec3& facing = Vec3::Zero()) const override;
  std::optional<SurfacePoint> crossing(const Vec3& a, const Vec3& b, Configuration c,
                                       const Vec3& facing = Vec3::Zero()) const override;
  Vec3 surface_normal(Index triangle, Configuration c) const override;
  int region(const EmbeddedPoint& p) const override;
  std::optional<int> find_region(const std::string& name_or_tag, std::string& error) const override;
  Elasticity elasticity(const EmbeddedPoint& p) const override;

  // MeshedSolid
  TriangleSurface surface(Configuration c) const override { return queries(c).surface(); }
  EmbeddedPoint on_surface(Index triangle, const Vec3& weights) const override;

 private:
  const SolidQueries& queries(Configuration c) const {
    return queries_[static_cast<std::size_t>(c)];
  }
  void doubt(Setup& setup) const;
  void doubt_size(Setup& setup) const;
  bool may_be_held(const Scene& scene) const;
  bool touches_itself(const Scene& scene) const;
  void update_materials();
  void start_moving();
  void move_queries(Configuration c, const VecX& x) {
    queries_[static_cast<std::size_t>(c)].move(x);
  }

  std::map<int, Material> layers_;  ///< by region, as far as layers have spoken
  TissueModel model_;
  std::unique_ptr<TissueSolver> own_solver_;
  TissueSolver* solver_ = nullptr;
  std::optional<TissueStep> step_;
  std::vector<SolidQueries> queries_;  ///< rest, start, current
  bool may_overlap_ = false;           ///< no Contact keeps its walls apart
  SelfOverlap overlap_;
};

}  // namespace sutura::tissue
