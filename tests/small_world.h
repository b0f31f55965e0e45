// Point masses on linear springs with a dense A: bodies small enough for closed forms, stepped as
// src/runtime/step.cpp does, so that laws, builder and solver are tested together without scene or
// meshes.
#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <functional>

#include "solve/gauss_seidel.h"
#include "solve/law_check.h"
#include "sutura/constraints.h"
#include "sutura/scene.h"

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
  void correct(const StepContext& c, const VecX& force_change) override {
    guess(c, v + change_ + c.dt * factor_.solve(free(force_change)));
  }
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

/// Bodies and one function that builds the blocks at a guess; it is asked once more after each
/// pass.
class SmallWorld {
 public:
  using Build = std::function<void(ConstraintBuilder&)>;
  SmallWorld(std::vector<Body*> all, Real dt, Vec3 gravity = Vec3::Zero())
      : bodies(std::move(all)),
        context{.dt = dt, .time = 0, .step = 0, .gravity = gravity},
        builder(problem, {bodies.begin(), bodies.end()}) {}
  /// The last solve, with the events of the whole step. Bodies that are linear under rows that do
  /// not turn need one pass, and one more after an event.
  SolveReport step(const Build& build) {
    context.pass = 0;
    solved = false;
    for (Body* b : bodies) b->begin_step(context);
    rebuild(build);
    SolveReport report;
    Index events = 0;
    while (!solved && context.pass < limits.passes + events) {
      report = pass();
      ++context.pass;
      rebuild(build);
      if (!measure()) continue;
      const Index fired = fire_events(problem);
      events += fired;
      solved = fired == 0;
    }
    builder.accept();
    for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i]->end_step(context, force_on(i));
    ++context.step;
    context.time = static_cast<Real>(context.step) * context.dt;
    report.events = events;
    return report;
  }
  /// Adds sign * directions (rows x 3) on a node to a block.
  void couple(BlockId id, const PointMasses& body, Index node, const MatX& directions) {
    PointJacobian J;
    J.nodes = 1;
    J.node[0] = node;
    J.coefficients = Mat3::Identity();
    builder.couple(id, body, directions, J, body.position(node, Configuration::current));
  }

  std::vector<Body*> bodies;
  StepContext context;  ///< after a step, `pass` is how many it took
  StepLimits limits{.substeps = 1};
  ConstraintProblem problem;
  ConstraintBuilder builder;
  BlockGaussSeidel solver;
  LawCheck check;
  bool solved = false;  ///< the last step met the limits

 private:
  void rebuild(const Build& build) {
    using Warm = ConstraintBuilder::Warm;
    builder.begin(context.pass == 0 ? Warm::step_before : Warm::pass_before);
    build(builder);
    builder.finish();
  }
  SolveReport pass() {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      bodies[i]->linearise(context, force_on(i));
      problem.bodies[i].add_product(context.dt, bodies[i]->change(), problem.d_free);
    }
    problem.W.setZero(problem.rows(), problem.rows());
    for (std::size_t i = 0; i < bodies.size(); ++i)
      if (problem.bodies[i].size() > 0)
        bodies[i]->add_compliance(problem.bodies[i], context.dt, problem.W);
    check.begin(problem);
    problem.hold_events = true;
    const GrowingVec before = problem.lambda;
    const SolveReport report = solver.solve(problem);
    const GrowingVec after = problem.lambda;
    problem.lambda -= before;
    for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i]->correct(context, force_on(i));
    problem.lambda = after;
    return report;
  }
  bool measure() {
    bool good = check.measure(problem).violation <= limits.gap_tolerance;
    for (std::size_t i = 0; i < bodies.size(); ++i)
      good = good && bodies[i]->imbalance(context, force_on(i)).relative <= limits.tolerance;
    return good;
  }
  VecX force_on(std::size_t body) const {
    VecX f = VecX::Zero(bodies[body]->dofs());
    problem.bodies[body].add_transposed(problem.lambda, f);
    return f;
  }
};

}  // namespace sutura::test
