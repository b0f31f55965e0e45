// <Tissue young="30 kPa" poisson="0.45"/>: a soft solid made of tetrahedra, implicit Euler.
// Equations: docs/theory/tissue.md.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <vector>

#include "block_matrix.h"
#include "elastic_model.h"
#include "solid_queries.h"
#include "sutura/body.h"
#include "sutura/component.h"
#include "sutura/describe.h"
#include "tet_mesh.h"
#include "tissue_solver.h"

namespace sutura {

/// unstated: t4, with a warning where it is too stiff. t4: corotational linear tets. smoothed: the
/// same tets, cured of locking (smoothed_t4.h).
enum class TissueElement { unstated, t4, smoothed };

class Tissue : public Component, public MeshedSolid {
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
  void fix(const std::vector<Index>& nodes);
  /// Holds a node along the axes for which `along` is not zero, by a spring that is stiff against
  /// the tissue; it stays free along the others. Returns the number of the support.
  Index support(Index node, const std::array<bool, 3>& along);
  /// A fixed node that will be carried. Returns the number of its carrier.
  Index carrier(Index fixed_node);
  /// In stage inputs: where the node is to be at the end of the step.
  void carry(Index carrier, const Vec3& target);
  void carry_support(Index support, const Vec3& target);

  /// Force (N) with which fixed nodes are held, over the last step: the momentum that their rows of
  /// the unconstrained equations lack. Zero for free nodes.
  Vec3 reaction(const std::vector<Index>& nodes) const;
  Index inverted() const;  ///< tets of negative or zero volume
  Real max_displacement() const;
  Real kinetic_energy() const;  ///< J
  Real elastic_energy() const;  ///< J
  Vec3 lowest() const;          ///< the node with the smallest z
  const std::vector<Real>& node_mass() const { return mass_; }
  const VecX& positions() const { return x_; }          ///< m, node by node
  const VecX& velocities() const { return v_; }         ///< m/s
  const VecX& rest_positions() const { return rest_; }  ///< m
  /// For restarts and tests. Fixed nodes are fixed where they are put; their velocity becomes zero.
  void set_state(const VecX& x, const VecX& v);
  const TissueSolveReport& solve_report() const { return solver_->report(); }

  // Body
  Index dofs() const override { return x_.size(); }
  int width() const override { return 3; }
  bool wants_settling() const override { return settles; }
  std::string settle(const Vec3& gravity) override;
  void begin_step(const StepContext& context) override;
  void linearise(const StepContext& context, const VecX& force) override;
  Eigen::Ref<const VecX> change() const override { return change_; }
  Vec3 position(const EmbeddedPoint& p, Configuration c) const override;
  void jacobian(const EmbeddedPoint& p, PointJacobian& out) const override;
  void solve(Eigen::Ref<MatX> columns) const override;
  void add_compliance(const BodyRows& rows, Real dt, Eigen::Ref<MatX> W) const override;
  void correct(const StepContext& context, const VecX& force_change) override;
  Imbalance imbalance(const StepContext& context, const VecX& force) override;
  Index least_passes() const override { return iterations; }
  void end_step(const StepContext& context, const VecX& force) override;
  Vec3 momentum() const override;
  Real mass() const override;
  Vec3 centre_of_mass() const override;
  Real energy() const override { return kinetic_energy() + elastic_energy(); }
  Real power(const VecX& force) const override { return force.dot(v_); }
  Real held_power() const override { return reaction_.dot(v_); }
  bool finite() const override;
  std::string trouble() const override;
  std::string fault() const override;
  BodyGeometry geometry() const override;

  // SolidBody
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
  void update_materials();
  void assemble(const StepContext& context);
  void balance(const StepContext& context);
  void solve_what_matters(const StepContext& context, VecX& momentum);
  Real moved_since_linearised() const;
  void move_queries(Configuration c, const VecX& x);
  void start_moving();
  void stiffen_supports(Real scale);
  void add_outer_forces();

  // Input, after the layers have spoken.
  std::map<int, Material> materials_;
  std::vector<Material> tet_material_;
  std::vector<Real> mass_;   ///< lumped, per node (kg)
  std::vector<char> fixed_;  ///< per node
  Real edge_length_ = 0;     ///< mean, at rest (m)
  struct Support {
    Index node = 0;
    std::array<bool, 3> along{};
    Vec3 target = Vec3::Zero();
  };
  Vec3 support_force(const Support& support) const;
  std::vector<Support> supports_;
  VecX slides_;                 ///< per dof: 0 where a support holds it, else 1
  Real support_stiffness_ = 0;  ///< N/m
  struct Carried {
    Index node = 0;
    Vec3 target = Vec3::Zero();
  };
  std::vector<Carried> carried_;

  // State; during a step, the guess of its end.
  VecX x_, v_;

  // The step: where it began, and what is known at the guess.
  bool in_step_ = false;
  VecX start_x_, start_v_;
  VecX elastic_force_;      ///< N
  VecX missing_;            ///< momentum due there, without constraint forces and reactions (N s)
  VecX linearised_at_;      ///< positions at which A_ was made
  Real assembled_for_ = 0;  ///< and the length of the step (s)
  Real at_work_ = 0;        ///< size of the forces there, when last measured (N)
  VecX change_;             ///< of the velocity, that answers it (m/s)

  // Caches.
  VecX rest_;
  VecX rhs_, product_, reaction_;
  Index linearisations_ = 0;    ///< in the last step
  std::string solver_trouble_;  ///< in all of them but the last, which the solver still knows
  std::unique_ptr<ElasticModel> elastic_;
  std::unique_ptr<NodeMatrix> A_;
  std::unique_ptr<TissueSolver> own_solver_;
  TissueSolver* solver_ = nullptr;
  std::vector<Mat3> node_rotations_;
  std::vector<SolidQueries> queries_;  ///< rest, start, current
};

}  // namespace sutura
