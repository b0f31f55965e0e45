// Point masses on linear springs with a dense A: bodies small enough for closed forms, in a
// simulation with rows of the test's own.
#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <functional>
#include <stdexcept>

#include "sutura/constraints.h"
#include "sutura/describe.h"
#include "sutura/plugin.h"
#include "sutura/simulation.h"
#include "sutura/units.h"

namespace sutura::test {

class PointMasses : public Body {
 public:
  explicit PointMasses(int nodes, Real mass) : x(VecX::Zero(3 * nodes)), v(x), force(x), rest_(x) {
    mass_.setConstant(3 * nodes, mass);
    K_.setZero(3 * nodes, 3 * nodes);
    fixed_.assign(static_cast<std::size_t>(3 * nodes), false);
  }
  /// Linear spring on one coordinate of a node, or between two nodes along a unit vector.
  void add_spring(int node, int axis, Real k) { K_(3 * node + axis, 3 * node + axis) += k; }
  void add_spring(int a, int b, const Vec3& along, Real k) {
    const Mat3 block = k * along * along.transpose();
    K_.block<3, 3>(3 * a, 3 * a) += block;
    K_.block<3, 3>(3 * b, 3 * b) += block;
    K_.block<3, 3>(3 * a, 3 * b) -= block;
    K_.block<3, 3>(3 * b, 3 * a) -= block;
  }
  /// The node moves with `velocity`, whatever pushes back.
  void prescribe(int node, const Vec3& velocity) {
    for (int i = 0; i < 3; ++i) fixed_[static_cast<std::size_t>(3 * node + i)] = true;
    v.segment<3>(3 * node) = velocity;
  }
  void place(int node, const Vec3& p) {
    x.segment<3>(3 * node) = p;
    rest_.segment<3>(3 * node) = p;
  }

  Index dofs() const override { return x.size(); }
  int width() const override { return 3; }
  void begin_step(const StepContext& c) override {
    if (!in_step_) start_x_ = x, start_v_ = v;
    in_step_ = true;
    if (c.dt != factored_for_) factorise(c.dt);
    guess(c, start_v_);
  }
  void linearise(const StepContext& c, const VecX& f) override {
    change_ = factor_.solve(missing_ + c.dt * free(f));
  }
  Eigen::Ref<const VecX> change() const override { return change_; }
  Vec3 position(Index node, Configuration c) const {
    const bool began = start_x_.size() > 0;
    const VecX& from = c == Configuration::rest             ? rest_
                       : c == Configuration::start && began ? start_x_
                                                            : x;
    return from.segment<3>(3 * node);
  }
  void solve(Eigen::Ref<MatX> columns) const override {
    for (Index i = 0; i < columns.rows(); ++i)
      if (fixed_[static_cast<std::size_t>(i)]) columns.row(i).setZero();
    columns = factor_.solve(columns).eval();
  }
  void push(const StepContext& c, const VecX& force_change) override {
    change_ += c.dt * factor_.solve(free(force_change));
  }
  void correct(const StepContext& c) override { guess(c, v + change_); }
  Imbalance imbalance(const StepContext& c, const VecX& f) override {
    const VecX r = missing_ / c.dt + free(f);
    const Real worst = r.lpNorm<Eigen::Infinity>();
    const Real at_work = std::max({f.lpNorm<Eigen::Infinity>(), force.lpNorm<Eigen::Infinity>(),
                                   spring_.lpNorm<Eigen::Infinity>(), inertia_ / c.dt});
    return {worst, at_work > 0 ? worst / at_work : 0};
  }
  void end_step(const StepContext&, const VecX&) override { in_step_ = false; }
  Vec3 momentum() const override {
    Vec3 p = Vec3::Zero();
    for (Index i = 0; i < x.size(); ++i) p[i % 3] += mass_[i] * v[i];
    return p;
  }
  Real mass() const override { return mass_.sum() / 3; }
  Real energy() const override {
    return 0.5 * mass_.cwiseProduct(v).dot(v) + 0.5 * (x - rest_).dot(K_ * (x - rest_));
  }
  bool finite() const override { return x.allFinite() && v.allFinite(); }
  BodyGeometry geometry() const override { return {}; }

  VecX x, v, force;  ///< m, m/s, N

 private:
  /// Zero where a coordinate is prescribed.
  VecX free(VecX f) const {
    for (Index i = 0; i < f.size(); ++i)
      if (fixed_[static_cast<std::size_t>(i)]) f[i] = 0;
    return f;
  }
  /// Moves to a guess of the velocity at the end; finds what its balance lacks (N s).
  void guess(const StepContext& c, const VecX& velocity) {
    v = velocity;
    x = start_x_ + c.dt * v;
    spring_ = K_ * (x - rest_);
    const VecX due = mass_.cwiseProduct(start_v_ - v);
    inertia_ = due.lpNorm<Eigen::Infinity>();
    missing_ = due + c.dt * (force - spring_);
    for (Index i = 0; i < x.size(); ++i) missing_[i] += c.dt * mass_[i] * c.gravity[i % 3];
    missing_ = free(missing_);
  }
  void factorise(Real h) {  // A does not change from step to step
    MatX A = h * h * K_;
    A.diagonal() += mass_;
    for (Index i = 0; i < A.rows(); ++i) {
      if (!fixed_[static_cast<std::size_t>(i)]) continue;
      A.row(i).setZero();
      A.col(i).setZero();
      A(i, i) = 1;
    }
    factor_.compute(A);
    factored_for_ = h;
  }

  VecX rest_, mass_, start_x_, start_v_, missing_, spring_, change_;
  Real inertia_ = 0;  ///< N s
  Real factored_for_ = 0;
  bool in_step_ = false;
  MatX K_;
  std::vector<bool> fixed_;
  Eigen::LDLT<MatX> factor_;
};

/// A body of the test as a component of the scene.
class LentBody : public Component, public Body {
 public:
  static void describe(Describe<LentBody>& d) { d.summary("A body of a test."); }
  Body* lent = nullptr;

  Index dofs() const override { return lent->dofs(); }
  int width() const override { return lent->width(); }
  void begin_step(const StepContext& c) override { lent->begin_step(c); }
  void linearise(const StepContext& c, const VecX& force) override { lent->linearise(c, force); }
  Eigen::Ref<const VecX> change() const override { return lent->change(); }
  void solve(Eigen::Ref<MatX> columns) const override { lent->solve(columns); }
  void push(const StepContext& c, const VecX& change) override { lent->push(c, change); }
  void correct(const StepContext& c) override { lent->correct(c); }
  Imbalance imbalance(const StepContext& c, const VecX& f) override {
    return lent->imbalance(c, f);
  }
  void end_step(const StepContext& c, const VecX& force) override { lent->end_step(c, force); }
  Vec3 momentum() const override { return lent->momentum(); }
  Real mass() const override { return lent->mass(); }
  Real energy() const override { return lent->energy(); }
  bool finite() const override { return lent->finite(); }
  BodyGeometry geometry() const override { return lent->geometry(); }
};

/// Rows as a function of the test.
class TestRows : public Component, public ConstraintSource {
 public:
  static void describe(Describe<TestRows>& d) { d.summary("Rows of a test."); }
  std::function<void(ConstraintBuilder&)> rows;
  void build(const StepContext&, ConstraintBuilder& builder) override {
    if (rows) rows(builder);
  }
};

/// A simulation of these bodies. Each step is given a function that makes the rows at a guess; it
/// is asked before the first pass and after every pass.
class SmallWorld {
 public:
  using Build = std::function<void(ConstraintBuilder&)>;
  struct Settings {
    Real dt = 0.01;                ///< s
    Vec3 gravity = Vec3::Zero();   ///< m/s^2
    Real gap_tolerance = 1e-6;     ///< m
    Real solver_tolerance = 1e-9;  ///< of the law residual
  };

  SmallWorld(const std::vector<Body*>& bodies, const Settings& settings) {
    enrol_builtin(registry_);
    registry_.component<LentBody>("LentBody");
    registry_.component<TestRows>("TestRows");
    std::string text = "<sutura version='1' substeps='1' dt='" + format_real(settings.dt) +
                       "' gap_tolerance='" + format_real(settings.gap_tolerance) + "' gravity='" +
                       format_real(settings.gravity.x()) + " " + format_real(settings.gravity.y()) +
                       " " + format_real(settings.gravity.z()) + "'><GaussSeidel tolerance='" +
                       format_real(settings.solver_tolerance) + "'/><TestRows name='rows'/>";
    for (std::size_t i = 0; i < bodies.size(); ++i)
      text += "<LentBody name='b" + std::to_string(i) + "'/>";
    Diagnostics diagnostics;
    auto scene = load_scene_text(text + "</sutura>", "test.xml", ".", registry_, diagnostics);
    for (std::size_t i = 0; scene && i < bodies.size(); ++i)
      dynamic_cast<LentBody&>(*scene->find("/b" + std::to_string(i))).lent = bodies[i];
    if (scene) simulation_ = Simulation::compile(std::move(scene), ".", diagnostics);
    if (!simulation_) throw std::runtime_error(diagnostics.all().front().text());
    rows_ = dynamic_cast<TestRows*>(simulation_->find("/rows"));
  }
  /// Bodies that are linear under rows that do not turn need one pass, and one more after an event.
  const StepReport& step(const Build& build) {
    rows_->rows = build;
    return simulation_->step();
  }
  Real time() const { return simulation_->time(); }
  const ConstraintProblem& problem() const { return simulation_->problem(); }
  /// W of the rows as they are (m/N).
  MatX compliance() const {
    MatX W = MatX::Zero(problem().rows(), problem().rows());
    for (std::size_t i = 0; i < problem().bodies.size(); ++i)
      simulation_->bodies()[i].body->add_compliance(problem().bodies[i], simulation_->scene().dt,
                                                    W);
    return W;
  }
  /// Adds directions (rows x 3) on a node to a block.
  void couple(ConstraintBuilder& builder, BlockId id, const PointMasses& body, Index node,
              const MatX& directions) {
    PointJacobian J;
    J.nodes = 1;
    J.node[0] = node;
    J.coefficients = Mat3::Identity();
    for (const Simulation::NamedBody& b : simulation_->bodies())
      if (dynamic_cast<LentBody&>(*b.body).lent == &body)
        builder.couple(id, *b.body, directions, J, body.position(node, Configuration::current));
  }

 private:
  Registry registry_;
  std::unique_ptr<Simulation> simulation_;
  TestRows* rows_ = nullptr;
};

}  // namespace sutura::test
