// Point masses on linear springs with a dense A: bodies small enough for closed forms, stepped as
// src/runtime/step.cpp does, so that laws, builder and solver are tested together without scene or
// meshes.
#pragma once

#include <Eigen/Cholesky>
#include <functional>

#include "solve/compliance_stage.h"
#include "solve/gauss_seidel.h"
#include "sutura/constraints.h"

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
  void free_motion(const StepContext& c) override {
    const Real h = c.dt;
    VecX b = h * (force - K_ * (x - rest_) - h * (K_ * v));
    for (Index i = 0; i < b.size(); ++i) {
      b[i] += h * mass_[i] * c.gravity[i % 3];
      if (fixed_[static_cast<std::size_t>(i)]) b[i] = 0;
    }
    if (h != factored_for_) factorise(h);
    dv_ = factor_.solve(b);
    free_ = x + h * (v + dv_);
  }
  Vec3 position(const EmbeddedPoint& p, Configuration c) const override {
    const VecX& from = c == Configuration::free ? free_ : c == Configuration::rest ? rest_ : x;
    return from.segment<3>(3 * p.element);
  }
  void jacobian(const EmbeddedPoint& p, PointJacobian& J) const override {
    J.nodes = 1;
    J.width = 3;
    J.node[0] = p.element;
    J.coefficients = Mat3::Identity();
  }
  void solve(Eigen::Ref<MatX> columns) const override {
    for (Index i = 0; i < columns.rows(); ++i)
      if (fixed_[static_cast<std::size_t>(i)]) columns.row(i).setZero();
    columns = factor_.solve(columns).eval();
  }
  void correct(const StepContext& c, const VecX& f) override {
    MatX extra = f;
    solve(extra);
    v += dv_ + c.dt * extra;
    x += c.dt * v;
  }
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

  VecX rest_, mass_, free_, dv_;
  Real factored_for_ = 0;
  MatX K_;
  std::vector<bool> fixed_;
  Eigen::LDLT<MatX> factor_;
};

inline EmbeddedPoint node(Index i) {
  return {i, {}};
}

/// Bodies and one function that builds the blocks of a step.
class SmallWorld {
 public:
  using Build = std::function<void(ConstraintBuilder&)>;
  SmallWorld(std::vector<Body*> all, Real dt, Vec3 gravity = Vec3::Zero())
      : bodies(std::move(all)),
        context{.dt = dt, .time = 0, .step = 0, .gravity = gravity},
        builder(problem, {bodies.begin(), bodies.end()}) {
    // c01 to c07 are about the laws: solve them well below the tolerance of any comparison.
    solver.options().tolerance = 1e-9;
  }
  SolveReport step(const Build& build) {
    for (Body* b : bodies) b->free_motion(context);
    builder.begin();
    build(builder);
    builder.finish();
    std::vector<ComplianceReport> reports(bodies.size());
    const std::vector<const Body*> all(bodies.begin(), bodies.end());
    ComplianceStage().run(all, problem, context.dt, ComplianceForm::automatic, {}, reports);
    const SolveReport report = solver.solve(problem);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      VecX f = VecX::Zero(bodies[i]->dofs());
      problem.bodies[i].add_transposed(problem.lambda, f);
      bodies[i]->correct(context, f);
    }
    ++context.step;
    context.time = static_cast<Real>(context.step) * context.dt;
    return report;
  }
  /// Adds sign * directions (rows x 3) on a node to a block.
  void couple(BlockId id, const Body& body, Index at, const MatX& directions) {
    PointJacobian J;
    body.jacobian(node(at), J);
    builder.couple(id, body, directions, J, body.position(node(at), Configuration::current));
  }

  std::vector<Body*> bodies;
  StepContext context;
  ConstraintProblem problem;
  ConstraintBuilder builder;
  BlockGaussSeidel solver;
};

}  // namespace sutura::test
