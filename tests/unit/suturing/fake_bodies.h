// The smallest bodies on which the suturing components can be judged by closed forms: a rigid
// straight needle moved by hand and a rigid slab on a spring. Registered as components, so that the
// real scene, compile and step run.
#pragma once

#include <algorithm>
#include <cmath>

#include "sutura/body.h"
#include "sutura/describe.h"

namespace sutura::testing {

/// Straight, pointing down; its travel is a polyline in time, whatever pushes back.
struct RigidNeedle : Component, CurveBody {
  std::vector<Real> times{0}, travel{0};
  Real start_height = 0, length_ = 0.1, radius_ = 0.25e-3, sideways = 0;
  Real swage = 0.1;  // where the needle ends and thread begins
  Real start_ = 0, now_ = 0;
  VecX change_ = VecX::Zero(3);

  static void describe(Describe<RigidNeedle>& d) {
    d.summary("Rigid straight needle along -z.");
    d.attribute("times", &RigidNeedle::times, "s", at_least(0), "Times of the key frames.");
    d.attribute("travel", &RigidNeedle::travel, "m", any(), "Travel at those times.");
    d.attribute("start_height", &RigidNeedle::start_height, "m", any(),
                "Height of the tip at travel 0.");
    d.attribute("radius", &RigidNeedle::radius_, "m", above(0), "Radius.");
    d.attribute("swage", &RigidNeedle::swage, "m", at_least(0),
                "Length of the needle; thread behind it.");
    d.output("travel", "m", "Travel.", [](const RigidNeedle& n) { return n.now_; });
  }
  Real at(Real t) const {
    for (std::size_t i = 1; i < times.size(); ++i) {
      if (t <= times[i]) {
        const Real a = std::clamp((t - times[i - 1]) / (times[i] - times[i - 1]), 0., 1.);
        return travel[i - 1] + a * (travel[i] - travel[i - 1]);
      }
    }
    return travel.back();
  }
  Index dofs() const override { return 3; }
  int width() const override { return 3; }
  void begin_step(const StepContext& c) override {
    start_ = at(c.time);
    now_ = at(c.end());
  }
  void linearise(const StepContext&, const VecX&) override {}
  Eigen::Ref<const VecX> change() const override { return change_; }
  void jacobian(Real, PointJacobian& J) const override {
    J.nodes = 1;
    J.width = 3;
    J.node[0] = 0;
    J.coefficients = Mat3::Identity();
  }
  void solve(Eigen::Ref<MatX> columns) const override { columns.setZero(); }
  void push(const StepContext&, const VecX&) override {}
  void correct(const StepContext&) override {}
  Imbalance imbalance(const StepContext&, const VecX&) override { return {}; }
  void end_step(const StepContext&, const VecX&) override {}
  Vec3 momentum() const override { return Vec3::Zero(); }
  Real mass() const override { return 0; }
  Real energy() const override { return 0; }
  bool finite() const override { return true; }
  BodyGeometry geometry() const override { return {}; }

  Real length() const override { return length_; }
  Real needle_length() const override { return swage; }
  Real radius(Real) const override { return radius_; }
  Real tension(Real) const override { return 0; }
  Vec3 point(Real s, Configuration c) const override {
    const Real t = c == Configuration::start ? start_ : c == Configuration::current ? now_ : 0;
    return {sideways, 0, start_height - t + s};
  }
  Vec3 tangent(Real, Configuration) const override { return Vec3::UnitZ(); }
  Pose frame(Real s, Configuration c) const override { return {point(s, c), Quat::Identity()}; }
  Real closest_abscissa(const Vec3& p, Real, Real low, Real high, Configuration c) const override {
    return std::clamp(p.z() - point(0, c).z(), low, high);
  }
  Index add_hold(Real) override { return 0; }
  void set_hold(Index, const Pose&, const HoldStiffness&) override {}
  void release_hold(Index) override {}
  Wrench hold_wrench(Index) const override { return {}; }
};

/// Top at z = 0, as deep as `thickness`, wide without end or up to x = `side`; every point moves
/// with one node on a spring.
struct SpringSlab : Component, SolidBody {
  Real stiffness = 300, mass_ = 1e-6, thickness = 1, side = INFINITY;
  std::vector<Real> youngs;  ///< per region, Pa; none: not known
  std::vector<Real> layers;  ///< depths at which the region number grows by one, from region 1
  Vec3 u_ = Vec3::Zero(), v_ = Vec3::Zero(), start_u_ = Vec3::Zero(), start_v_ = Vec3::Zero();
  VecX change_ = VecX::Zero(3);
  Real h_ = 0;
  bool in_step_ = false;

  static void describe(Describe<SpringSlab>& d) {
    d.summary("Rigid slab on a spring.");
    d.attribute("stiffness", &SpringSlab::stiffness, "N/m", above(0), "Stiffness.");
    d.attribute("mass", &SpringSlab::mass_, "kg", above(0), "Mass.");
    d.attribute("thickness", &SpringSlab::thickness, "m", above(0), "Thickness.");
    d.attribute("layers", &SpringSlab::layers, "m", above(0),
                "Depths of the layers under the first.");
    d.attribute("youngs", &SpringSlab::youngs, "Pa", above(0), "Young modulus per layer.");
    d.output("force", "N", "Of the spring, upwards.",
             [](const SpringSlab& s) { return -s.stiffness * s.u_.z(); });
  }
  const Vec3& shift(Configuration c) const {
    static const Vec3 zero = Vec3::Zero();
    return c == Configuration::start ? start_u_ : c == Configuration::current ? u_ : zero;
  }
  Real inverse() const { return 1 / (mass_ + h_ * h_ * stiffness); }
  Index dofs() const override { return 3; }
  int width() const override { return 3; }
  Vec3 missing() const { return mass_ * (start_v_ - v_) - h_ * stiffness * u_; }
  void begin_step(const StepContext& c) override {
    if (!in_step_) start_u_ = u_, start_v_ = v_;
    in_step_ = true;
    h_ = c.dt;
    v_ = start_v_;
    u_ = start_u_ + h_ * v_;
  }
  void linearise(const StepContext&, const VecX& force) override {
    change_ = inverse() * (missing() + h_ * force);
  }
  Eigen::Ref<const VecX> change() const override { return change_; }
  Vec3 position(const EmbeddedPoint& p, Configuration c) const override {
    return Vec3(p.weights[0], p.weights[1], p.weights[2]) + shift(c);
  }
  void jacobian(const EmbeddedPoint&, PointJacobian& J) const override {
    J.nodes = 1;
    J.width = 3;
    J.node[0] = 0;
    J.coefficients = Mat3::Identity();
  }
  void solve(Eigen::Ref<MatX> columns) const override { columns *= inverse(); }
  void push(const StepContext&, const VecX& force_change) override {
    change_ += h_ * inverse() * force_change;
  }
  void correct(const StepContext&) override {
    v_ += change_;
    u_ = start_u_ + h_ * v_;
  }
  Imbalance imbalance(const StepContext&, const VecX& force) override {
    const Real lacking = (missing() / h_ + force).norm();
    const Real at_work = force.norm() + stiffness * u_.norm() + 1e-12;
    return {lacking, lacking / at_work};
  }
  void end_step(const StepContext&, const VecX&) override { in_step_ = false; }
  Vec3 momentum() const override { return mass_ * v_; }
  Real mass() const override { return mass_; }
  Real energy() const override { return 0; }
  bool finite() const override { return u_.allFinite(); }
  BodyGeometry geometry() const override { return {}; }

  static EmbeddedPoint embedded(const Vec3& material) {
    return {0, {material.x(), material.y(), material.z(), 0}};
  }
  std::optional<EmbeddedPoint> locate(const Vec3& p, Configuration c) const override {
    const Vec3 m = p - shift(c);
    if (m.z() > 0 || m.z() < -thickness || m.x() > side) return std::nullopt;
    return embedded(m);
  }
  SurfacePoint face(const Vec3& p, bool top, Configuration c) const {
    const Vec3 m = p - shift(c);
    const Vec3 foot(m.x(), m.y(), top ? 0 : -thickness);
    const Vec3 normal = top ? Vec3(0, 0, 1) : Vec3(0, 0, -1);
    return {embedded(foot), top ? 0 : 1, foot + shift(c), normal, normal.dot(m - foot)};
  }
  std::optional<SurfacePoint> closest_surface(const Vec3& p, Real reach, Configuration c,
                                              const Vec3& facing = Vec3::Zero()) const override {
    const bool nearer = (p - shift(c)).z() > -0.5 * thickness;
    const bool top = facing.z() == 0 ? nearer : facing.z() > 0;
    SurfacePoint s = face(p, top, c);
    if (std::abs(s.distance) > reach) return std::nullopt;
    return s;
  }
  std::optional<SurfacePoint> crossing(const Vec3& a, const Vec3& b, Configuration c,
                                       const Vec3& facing = Vec3::Zero()) const override {
    for (const bool top : {true, false}) {
      const Real level = (top ? 0 : -thickness) + shift(c).z();
      if ((a.z() - level) * (b.z() - level) < 0 && facing.z() * (top ? 1 : -1) >= 0) {
        return face(a + (b - a) * (level - a.z()) / (b.z() - a.z()), top, c);
      }
    }
    return std::nullopt;
  }
  Vec3 surface_normal(Index triangle, Configuration) const override {
    return triangle == 0 ? Vec3(0, 0, 1) : Vec3(0, 0, -1);
  }
  int region(const EmbeddedPoint& p) const override {
    int r = 1;
    for (const Real depth : layers) r += -p.weights[2] > depth;
    return r;
  }
  Elasticity elasticity(const EmbeddedPoint& p) const override {
    if (youngs.empty()) return {};
    return {youngs[static_cast<std::size_t>(region(p) - 1)], 0.45};
  }
};

}  // namespace sutura::testing
