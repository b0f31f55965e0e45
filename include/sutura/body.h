// A body: something with mass that moves. A curve is asked for its points by abscissa, a solid by
// element and weights.
//
// Every body integrates by implicit Euler. At a guess v of the velocity at the end of the step,
// A dv = M (v_start - v) + h (f(x) + weight - B v + H^T lambda) with A = M + h B + h^2 K. A change
// of lambda (N) is answered by dv += h A^-1 H^T lambda, so W = h^2 H A^-1 H^T (m/N). docs/step.md.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "sutura/types.h"

namespace sutura {

/// What the clock says during one step.
struct StepContext {
  Real dt = 0.01;  ///< s
  Real time = 0;   ///< s, at the start of the step
  Index step = 0;  ///< 0, 1, ...
  Index pass = 0;  ///< of this step: 0 at the first guess
  /// In time: of 2, a body may look back two steps (docs/theory/thread.md). 1 where there are rows.
  Index order = 1;
  Vec3 gravity = Vec3::Zero();
  Real tolerance = 1e-2;  ///< the largest relative imbalance that the end of the step may have
  Real early = 0;  ///< what is due by `time + early` happens at `time` (s; Driver::next_event)
  Real end() const { return time + dt; }
};

/// Which positions: at rest; at the start of the step; where the body is now, which during a step
/// is the guess of its end.
enum class Configuration { rest, start, current };

/// A point of a solid, in the coordinates of the material, so that it survives motion.
struct EmbeddedPoint {
  Index element = -1;
  std::array<Real, 4> weights{};  ///< barycentric, one per node of the element
};

/// velocity of a point = sum over nodes of coefficients(:, k*width .. ) * node velocity.
struct PointJacobian {
  static constexpr int max_nodes = 10;
  int nodes = 0;
  int width = 3;  ///< dofs per node: 3 (translation) or 6 (translation, rotation)
  std::array<Index, max_nodes> node{};
  Eigen::Matrix<Real, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 30> coefficients;  ///< 3 x nodes*width
};

/// The rows H of one body: row i touches entries start[i] .. start[i+1]; entry e is node[e] with
/// `width` coefficients at value[e*width].
struct BodyRows {
  int width = 3;
  std::vector<Index> row;    ///< row number in the whole problem, ascending
  std::vector<Index> start;  ///< size row.size() + 1
  std::vector<Index> node;
  std::vector<Real> value;

  void clear();
  Index size() const { return static_cast<Index>(row.size()); }
  /// force += H^T lambda; lambda over all rows of the problem, force over the dofs of the body.
  void add_transposed(const Eigen::Ref<const VecX>& lambda, VecX& force) const;
  /// delta += scale H u; u over the dofs of the body, delta over all rows of the problem.
  void add_product(Real scale, const Eigen::Ref<const VecX>& u, Eigen::Ref<VecX> delta) const;
};

/// Geometry and fields for recorders.
struct BodyGeometry {
  enum class Cell { line, tetrahedron };
  struct Field {
    std::string name;  ///< with unit: "velocity [m/s]"
    bool on_cells = false;
    int components = 1;
    std::vector<Real> values;
  };
  Cell cell = Cell::line;
  std::vector<Vec3> points;
  std::vector<Index> connectivity;  ///< 2 or 4 per cell
  std::vector<Field> fields;
};

/// A component that is no body and yet has a shape, which a VtuRecorder writes as it writes that of
/// a body. Where the geometry has no points, nothing is written for that step.
class Drawing {
 public:
  static constexpr const char* interface_name = "Drawing";
  virtual ~Drawing() = default;
  /// At the end of the last step.
  virtual BodyGeometry geometry() const = 0;
};

/// How far a body is from the balance of its momentum.
struct Imbalance {
  Real force = 0;     ///< largest over the nodes (N; moments divided by the length of a beam)
  Real relative = 0;  ///< the same against the forces at work there; 1: nothing is balanced
};

class Body {
 public:
  static constexpr const char* interface_name = "Body";
  virtual ~Body() = default;

  /// Nodes times width.
  virtual Index dofs() const = 0;
  virtual int width() const = 0;

  /// Loads of the step (N, N m; one per dof). Drivers add to it in stage inputs, before which the
  /// step empties it; the body feels it as a force that keeps its direction during the step.
  VecX& load() { return load_; }
  const VecX& load() const { return load_; }
  /// Whether the scene asks for `settle`: called once, before the first step and after the drivers
  /// have spoken for time 0. It moves the body into balance under its weight, loads and holds, at
  /// rest; what it could not do, as a sentence.
  virtual bool wants_settling() const { return false; }
  virtual std::string settle(const Vec3& /*gravity*/) { return {}; }

  /// Begins a step of length context.dt where the last one ended: makes a first guess. Called again
  /// before `end_step` it begins the same step anew, with another length.
  virtual void begin_step(const StepContext& context) = 0;
  /// Stage linearise: A at the guess, and the change of velocity it answers to what is missing of
  /// balance there under the present constraint force (N, N m; size dofs).
  virtual void linearise(const StepContext& context, const VecX& force) = 0;
  /// That change (m/s, rad/s; size dofs).
  virtual Eigen::Ref<const VecX> change() const = 0;

  /// Stage compliance: columns <- A^-1 columns (dofs x any), with the A of this step. Prescribed
  /// dofs answer zero.
  virtual void solve(Eigen::Ref<MatX> columns) const = 0;
  /// W(row, row') += h^2 H A^-1 H^T over the rows of this body. The default solves one column per
  /// row; a body that knows better overrides it, and may approximate: what a pass leaves of
  /// violation is measured, and the next pass takes it up.
  virtual void add_compliance(const BodyRows& rows, Real dt, Eigen::Ref<MatX> W) const;

  /// Stage correct: adds the answer to a change of the constraint force (N, N m; size dofs) to
  /// `change`. As often in a pass as its rows are solved.
  virtual void push(const StepContext& context, const VecX& force_change) = 0;
  /// Then: moves by `change` to the next guess. May go only part of the way if the linear answer
  /// cannot hold so far.
  virtual void correct(const StepContext& context) = 0;
  /// Whether the last `correct` went only part of the way.
  virtual bool went_part_way() const { return false; }
  /// The way from the start of the step to the guess, in the body's own coordinates (m, rad; size
  /// dofs; of each node, its shift comes first).
  /// Empty from a body that cannot be moved from outside.
  virtual void motion(VecX& out) const { out.resize(0); }
  /// Another guess: that far from the start of the step. What is held stays where it is held.
  virtual void move_to(const StepContext& /*context*/, const VecX& /*motion*/) {}
  /// Stage measure: what the guess lacks of balance under this constraint force.
  virtual Imbalance imbalance(const StepContext& context, const VecX& force) = 0;
  /// Once the guess is balanced: where it is no minimum of the body's potential (a straight thread
  /// pushed together), moves it on to where that is lower and returns true.
  virtual bool leave_saddle() { return false; }
  /// About how far the guess is from where the motion would be if the step were infinitely short
  /// (m): h/2 times the change of velocity, the largest over the nodes that nothing holds.
  virtual Real time_error(const StepContext& /*context*/) const { return 0; }
  /// Once the guess is balanced: does it tell well enough when within the step something happened
  /// to the body, as that a thread tore? If not, the step is too long.
  virtual bool tells_when() const { return true; }
  /// Once the guess of a step of second order is balanced: has the motion changed about as it did
  /// in the step before, to which such a step looks back? If not, the step is begun anew in first
  /// order.
  virtual bool goes_on_as_before(const StepContext& /*context*/) { return true; }
  /// Linearisations that a step takes at least, whatever the imbalance.
  virtual Index least_passes() const { return 1; }
  /// The guess is the end of the step. `force`: of the constraints on it.
  virtual void end_step(const StepContext& context, const VecX& force) = 0;

  /// Linear momentum (kg m/s) and mass (kg), for balance checks.
  virtual Vec3 momentum() const = 0;
  virtual Real mass() const = 0;
  /// m, at the current state; not a number if the body does not say.
  virtual Vec3 centre_of_mass() const {
    return Vec3::Constant(std::numeric_limits<Real>::quiet_NaN());
  }
  /// Kinetic plus elastic energy (J) at the current state; gravity excluded.
  virtual Real energy() const = 0;
  /// Power of a force (N, N m; size dofs) at the velocity of the guess (W), for energy balances;
  /// not a number if the body does not say.
  virtual Real power(const VecX& /*force*/) const { return std::numeric_limits<Real>::quiet_NaN(); }
  /// After `end_step`: power of what holds or moves parts of the body without being a constraint,
  /// as holds and supports do (W).
  virtual Real held_power() const { return 0; }
  /// False as soon as any coordinate is not finite.
  virtual bool finite() const = 0;
  /// What went wrong in the last step, a sentence; empty if nothing did.
  virtual std::string trouble() const { return {}; }

  /// Why the result of the last step cannot be trusted, although the step is solved; empty if it
  /// can.
  virtual std::string fault() const { return {}; }

  virtual BodyGeometry geometry() const = 0;

 private:
  VecX load_;
};

/// A point of the boundary of a solid.
struct SurfacePoint {
  EmbeddedPoint at;
  Index triangle = -1;
  Vec3 position = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  ///< unit, outward
  Real distance = 0;           ///< signed: positive outside
};

/// Isotropic, small strain.
struct Elasticity {
  Real young = 0;  ///< Pa; 0: not known
  Real poisson = 0;
};

/// A body with an inside: tissue.
class SolidBody : public Body {
 public:
  static constexpr const char* interface_name = "SolidBody";
  virtual Vec3 position(const EmbeddedPoint& p, Configuration c) const = 0;
  /// At the guess.
  virtual void jacobian(const EmbeddedPoint& p, PointJacobian& out) const = 0;
  /// The element that contains p, or nothing.
  virtual std::optional<EmbeddedPoint> locate(const Vec3& p, Configuration c) const = 0;
  /// The closest point of the boundary within `reach` (m) of p, or nothing. With `facing`: of that
  /// part of the boundary whose outward normal leans that way, as one side of a slit does.
  virtual std::optional<SurfacePoint> closest_surface(const Vec3& p, Real reach, Configuration c,
                                                      const Vec3& facing = Vec3::Zero()) const = 0;
  /// Where the segment from a to b first crosses the boundary (the part that is `facing` so), or
  /// nothing. `distance` is the signed distance of a along the normal.
  virtual std::optional<SurfacePoint> crossing(const Vec3& a, const Vec3& b, Configuration c,
                                               const Vec3& facing = Vec3::Zero()) const = 0;
  virtual Vec3 surface_normal(Index triangle, Configuration c) const = 0;
  /// Region tag of the mesh (layer).
  virtual int region(const EmbeddedPoint& p) const = 0;
  /// The tag of a region given by name or number, or nothing and a sentence that says what there
  /// is. A solid that cannot tell takes every number.
  virtual std::optional<int> find_region(const std::string& name_or_tag, std::string& error) const;
  virtual Elasticity elasticity(const EmbeddedPoint&) const { return {}; }
};

/// How firmly a hold keeps a section of a curve.
struct HoldStiffness {
  Real translation = 1e6;  ///< N/m
  Real rotation = 10;      ///< N m/rad
};

/// A body that is a curve, parametrised by arc length at rest ("abscissa", m): 0 at the needle tip,
/// growing towards the end of the thread.
class CurveBody : public Body {
 public:
  static constexpr const char* interface_name = "CurveBody";
  virtual Real length() const = 0;
  virtual Real needle_length() const = 0;  ///< 0 without needle
  virtual Real radius(Real s) const = 0;
  virtual Vec3 point(Real s, Configuration c) const = 0;
  /// Of the point at s, at the guess.
  virtual void jacobian(Real s, PointJacobian& out) const = 0;
  /// Unit vector in the direction of growing s.
  virtual Vec3 tangent(Real s, Configuration c) const = 0;
  /// Axial force at s as it is now, positive where the curve is taut (N).
  virtual Real tension(Real s) const = 0;
  /// Frame of the section: x axis along the tangent.
  virtual Pose frame(Real s, Configuration c) const = 0;
  /// The abscissa in [low, high] whose point is closest to p; starts from `guess` and follows the
  /// curve downhill, so that it cannot jump to another strand.
  virtual Real closest_abscissa(const Vec3& p, Real guess, Real low, Real high,
                                Configuration c) const = 0;

  /// Holds: a section tied to a moving pose by an implicit spring, part of A (a grasper, a clamp).
  /// `add_hold` is called from initialise, by components linked to this one; returns its number.
  virtual Index add_hold(Real s) = 0;
  /// Until changed: the section follows `target` (pose of its frame at the end of the step).
  virtual void set_hold(Index hold, const Pose& target, const HoldStiffness& stiffness) = 0;
  virtual void release_hold(Index hold) = 0;
  /// What the hold applies to the curve, over the last step.
  virtual Wrench hold_wrench(Index hold) const = 0;
};

}  // namespace sutura
