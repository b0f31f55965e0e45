// A path on a real thread: the problem that the thread's rows make.
#pragma once

#include <memory>

#include "../plugins/suturing/path_friction_law.h"
#include "../plugins/thread/suture_thread.h"
#include "sutura/laws/bilateral.h"

namespace sutura::test {

struct ThreadPathOptions {
  Index beams = 200;   ///< of 1 mm
  Index samples = 50;  ///< one per beam, three rows each: two across, one of friction
  Index first_beam = 20;
  bool tissue = true;  ///< every sample is also coupled to something assembled, 0.01 m/N falling
                       ///< off over 5 samples
  Real pull = 0.1;     ///< N, on the end of the thread
  Real dt = 0.01;      ///< s
};

/// Stands for the tissue: only its W matters here.
class AssembledBody : public Body {
 public:
  Index dofs() const override { return 3; }
  int width() const override { return 3; }
  void begin_step(const StepContext&) override {}
  void linearise(const StepContext&, const VecX&) override {}
  Eigen::Ref<const VecX> change() const override { return still_; }
  static void jacobian(PointJacobian& J) {
    J.nodes = 1;
    J.width = 3;
    J.node[0] = 0;
    J.coefficients = Mat3::Identity();
  }
  void solve(Eigen::Ref<MatX>) const override {}
  void add_compliance(const BodyRows& rows, Real, Eigen::Ref<MatX> W) const override {
    for (const Index i : rows.row)
      for (const Index j : rows.row)
        if (i % 3 == j % 3) W(i, j) += 0.01 * std::exp(-static_cast<Real>(std::abs(i - j)) / 15);
  }
  void push(const StepContext&, const VecX&) override {}
  void correct(const StepContext&) override {}
  Imbalance imbalance(const StepContext&, const VecX&) override { return {}; }
  void end_step(const StepContext&, const VecX&) override {}
  Vec3 momentum() const override { return Vec3::Zero(); }
  Real mass() const override { return 0; }
  Real energy() const override { return 0; }
  bool finite() const override { return true; }
  BodyGeometry geometry() const override { return {}; }

 private:
  VecX still_ = VecX::Zero(3);
};

class ThreadPath {
 public:
  explicit ThreadPath(const ThreadPathOptions& o) : options_(o) {
    thread.needle_arc_length = 0;
    thread.thread_beams = o.beams;
    thread.thread_length = 1e-3 * static_cast<Real>(o.beams);
    Diagnostics diagnostics;
    Setup setup{diagnostics, {}, {}, o.dt, Vec3::Zero(), 1};
    thread.initialise(setup);
    thread.ready(setup);
    const StepContext context{.dt = o.dt, .time = 0, .step = 0, .gravity = Vec3::Zero()};
    thread.begin_step(context);
    thread.linearise(context, VecX::Zero(thread.dofs()));
    bodies = {&thread, &tissue_};
    // How far the pull would move every node in the step: at an angle, so that all rows have
    // something to do.
    MatX moved = MatX::Zero(thread.dofs(), 1);
    moved.bottomRows<6>().col(0).head<3>() = o.dt * o.dt * o.pull * Vec3(0.9, 0.3, -0.3);
    thread.solve(moved);
    moved_ = moved.col(0);
  }
  /// The blocks of a step, and W.
  void build(ConstraintProblem& problem) {
    ConstraintBuilder builder(problem, bodies);
    builder.begin();
    for (Index i = 0; i < options_.samples; ++i) {
      PointJacobian J, at_tissue;
      const Real s = 1e-3 * (static_cast<Real>(options_.first_beam + i) + 0.3 +
                             0.4 * static_cast<Real>(i % 2));
      thread.jacobian(s, J);
      tissue_.jacobian(at_tissue);
      Vec3 gap =
          2e-5 * Vec3(std::sin(7. * static_cast<Real>(i)), std::sin(5. * static_cast<Real>(i)), 0);
      for (int k = 0; k < J.nodes; ++k)
        gap += J.coefficients.middleCols<6>(6 * k) *
               moved_.segment<6>(6 * J.node[static_cast<std::size_t>(k)]);
      const Eigen::Matrix<Real, 2, 3> across = Mat3::Identity().bottomRows<2>();
      const Eigen::Matrix<Real, 1, 3> along = Mat3::Identity().topRows<1>();
      const BlockId hold = builder.add<Bilateral<2>>(make_key(1, static_cast<std::uint64_t>(2 * i)),
                                                     {.compliance = 1e-4}, across * gap);
      const Real level = 0.002 + 0.001 * static_cast<Real>(i % 3);
      const BlockId friction = builder.add<suturing::PathFrictionLaw>(
          make_key(1, static_cast<std::uint64_t>(2 * i + 1)),
          {.static_level = level, .kinetic = level, .viscous = 1, .stick_slip = 1e-4 * options_.dt},
          BlockVector<1>(gap.x()), suturing::PathFrictionLaw::stick, {.force = 0.01});
      builder.couple(hold, thread, across, J, Vec3::Zero());
      builder.couple(friction, thread, along, J, Vec3::Zero());
      if (!options_.tissue) continue;
      builder.couple(hold, tissue_, -across, at_tissue, Vec3::Zero());
      builder.couple(friction, tissue_, -along, at_tissue, Vec3::Zero());
    }
    builder.finish();
    make_compliance(problem);
  }
  void make_compliance(ConstraintProblem& problem) const {
    problem.W.setZero(problem.rows(), problem.rows());
    for (std::size_t i = 0; i < bodies.size(); ++i)
      if (problem.bodies[i].size() > 0)
        bodies[i]->add_compliance(problem.bodies[i], options_.dt, problem.W);
  }

  thread::SutureThread thread;
  std::vector<const Body*> bodies;

 private:
  ThreadPathOptions options_;
  AssembledBody tissue_;
  VecX moved_;
};

}  // namespace sutura::test
