// One thread of a batch (plugins/opencl/threads.h) with the parts of the CPU: beams, matrix and
// factor of the thread plugin, rows with laws, Gauss-Seidel.
#pragma once

#include "rod_guess.h"
#include "rod_tangent.h"
#include "solve/gauss_seidel.h"
#include "solve_problems.h"
#include "threads.h"

namespace sutura::test {

class ThreadOnCpu {
 public:
  explicit ThreadOnCpu(const opencl::ThreadsProblem& p)
      : p_(p), friction_(VecX::Zero(p.points())), solver_({.tolerance = 1e-13}) {
    thread::RodLayout layout;
    const Quat q = Quat::FromTwoVectors(Vec3::UnitX(), p.direction);
    const Real beam = p.length / static_cast<Real>(p.beams);
    for (Index i = 0; i <= p.beams; ++i) {
      const Real s = beam * static_cast<Real>(i);
      layout.abscissa.push_back(s);
      layout.rest.push_back({p.start + s * p.direction.normalized(), q});
    }
    layout.start = layout.rest;
    layout.sections.assign(
        static_cast<std::size_t>(p.beams),
        {.radius = p.diameter / 2, .young = p.young, .poisson = p.poisson, .density = p.density});
    rod_.build(layout);
    rod_.springs().push_back({.node = p.beams,
                              .active = true,
                              .target = layout.rest.back(),
                              .stiffness = {.translation = p.hand, .rotation = p.hand_turning},
                              .applied = {}});
    start_.resize(rod_.nodes());
    guess_.resize(rod_.nodes());
    matrix_.resize(rod_.nodes());
    start_.dt = p.dt;
    start_.gravity = p.gravity;
  }

  /// The hand goes on with that velocity (m/s).
  void step(const Vec3& velocity) {
    using namespace thread;
    const Real h = p_.dt;
    rod_.springs()[0].target.position += h * velocity;
    rod_.mark_start();
    start_.twist = rod_.twist();
    start_.take(rod_, true);
    guess_.motion.setZero();
    guess_.move(rod_, start_);
    guess_.take_tension();
    assemble(rod_, start_, guess_, Tangent::convex, matrix_);
    if (!factor(matrix_)) throw std::runtime_error("the matrix is not positive definite");
    VecX v = guess_.missing;
    matrix_.solve(Eigen::Ref<VecX>(v));

    ConstraintProblem rows;
    const Index n = 3 * p_.points();
    MatX J = MatX::Zero(n, 6 * rod_.nodes());
    VecX gap = VecX::Zero(n);
    for (Index k = 0; k < p_.points(); ++k) {
      append<Bilateral<2>>(rows, {.compliance = 1 / p_.lateral});
      append<suturing::PathFrictionLaw>(rows,
                                        {.static_level = p_.friction, .kinetic = p_.friction});
      add_rows(k, J, gap);
    }
    MatX answers = J.transpose();
    matrix_.solve(Eigen::Ref<MatX>(answers));
    finish(rows, h * h * J * answers, gap + h * J * v);
    solver_.solve(rows);
    v += h * answers * rows.lambda;
    for (Index k = 0; k < p_.points(); ++k) friction_[k] = rows.lambda[3 * k + 2];
    guess_.motion = h * v;
    guess_.move(rod_, start_);
  }

  Vec3 hand_force() const { return rod_.springs()[0].wrench(rod_.poses().back()).force; }
  const VecX& friction() const { return friction_; }
  const Vec3& position(Index node) const { return rod_.poses()[node].position; }

 private:
  Vec3 point(Index k) const { return Eigen::Map<const Vec3>(&p_.path[3 * k]); }

  /// Two across the path, one along it, at the place of the thread that is closest.
  void add_rows(Index k, MatX& J, VecX& gap) const {
    const Index last = p_.points() - 1;
    const Vec3 t =
        (last == 0 ? p_.direction
                   : Vec3(point(std::min(k + 1, last)) - point(std::max<Index>(k - 1, 0))))
            .normalized();
    const Vec3 across = t.unitOrthogonal(), other = t.cross(across);
    Real best = std::numeric_limits<Real>::infinity(), share = 0;
    Index beam = 0;
    Vec3 off;
    for (Index e = 0; e < rod_.beams(); ++e) {
      const Vec3 a = position(e), chord = position(e + 1) - a;
      const Real s = std::clamp((point(k) - a).dot(chord) / chord.squaredNorm(), Real(0), Real(1));
      const Vec3 away = a + s * chord - point(k);
      if (away.norm() >= best) continue;
      best = away.norm();
      beam = e;
      share = s;
      off = away;
    }
    const Vec3 directions[] = {across, other, t};
    for (int r = 0; r < 3; ++r) {
      J.block<1, 3>(3 * k + r, 6 * beam) = (1 - share) * directions[r].transpose();
      J.block<1, 3>(3 * k + r, 6 * beam + 6) = share * directions[r].transpose();
      gap[3 * k + r] = r < 2 ? directions[r].dot(off) : 0;
    }
  }

  opencl::ThreadsProblem p_;
  thread::Rod rod_;
  thread::RodStart start_;
  thread::RodGuess guess_;
  thread::BlockTridiagonal matrix_;
  VecX friction_;
  BlockGaussSeidel solver_;
};

}  // namespace sutura::test
