// Whole steps of a tissue under 300 contacts with friction, without a scene: the stages of
// src/runtime/step.cpp with a rigid plate of points for a source.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "async_solver.h"
#include "compliance.h"
#include "corotational_t4.h"
#include "solve/gauss_seidel.h"
#include "solve/law_check.h"
#include "solve_problems.h"
#include "sutura/laws/coulomb.h"
#include "tissue_pad.h"
#include "tissue_step.h"

namespace sutura::bench {

/// A pad, held below; a plate presses on its middle and rubs along it.
class PressedPad {
 public:
  static constexpr int across = 20, along = 15, contacts = across * along;
  enum Stage { linearise, compliance, solve, correct, measure, stages };
  static constexpr std::array<const char*, stages> stage_names{"linearise", "compliance", "solve",
                                                               "correct", "measure"};
  struct StepCost {
    std::array<double, stages> ms{};
    double total = 0;
    Index passes = 0, iterations = 0, outside = 0, age = 0, sweeps = 0, direct = 0;
    bool solved = false;
    std::string message;
  };

  PressedPad(std::array<int, 3> cells, Real cell, Real dt)
      : cells_(cells),
        cell_(cell),
        mesh_(test::kuhn_block(cells, cell * Vec3(cells[0], cells[1], cells[2]))),
        top_(cell * cells[2]) {
    context_.dt = dt;
    context_.gravity = Vec3(0, 0, -9.81);
    const Material material{.young = 1e4, .poisson = 0.45, .density = 1000};
    model_.mesh = &mesh_;
    model_.rest = test::stacked(mesh_.points);
    model_.materials.assign(mesh_.tets.size(), material);
    model_.elastic = std::make_unique<CorotationalT4>(mesh_.points, mesh_.tets);
    model_.elastic->set_materials(model_.materials);
    model_.mass.assign(mesh_.points.size(), 0);
    for (const Tet& t : mesh_.tets) {
      const auto& p = mesh_.points;
      const Real volume = std::abs(six_volume(p[t[0]], p[t[1]], p[t[2]], p[t[3]])) / 6;
      for (const Index i : t) model_.mass[at(i)] += material.density * volume / 4;
    }
    model_.held = HeldNodes(static_cast<Index>(mesh_.points.size()));
    std::vector<Index> below;
    for (std::size_t i = 0; i < mesh_.points.size(); ++i)
      if (mesh_.points[i].z() < 1e-9) below.push_back(static_cast<Index>(i));
    model_.held.fix(below);
    model_.edge_length = cell;
    model_.young = material.young;
    std::mt19937_64 random(1);
    std::uniform_real_distribution<Real> some(-1, 1);
    for (int j = 0; j < along; ++j)
      for (int i = 0; i < across; ++i) {
        const Real x = spacing * (i - 0.5 * (across - 1)) + 1e-4 * some(random),
                   y = spacing * (j - 0.5 * (along - 1)) + 1e-4 * some(random);
        plate_.push_back({x, y, 0.5 * (x * x + y * y) / 0.2});  // a cap of 200 mm radius
      }
  }
  Index nodes() const { return static_cast<Index>(mesh_.points.size()); }
  /// Before `begin`: how accurate A^-1 b is, and how many passes every step makes, whatever is
  /// missing before; 0: until the step is solved.
  void set_passes(Index passes, Real tolerance) {
    passes_ = passes;
    AsyncOptions options = solver_.options();
    options.tolerance = tolerance;
    options.lag = 2;  // the same factors in every run
    solver_.set_options(std::move(options));
  }
  /// Of the last step: normal, tangent, tangent of each contact (N).
  const GrowingVec& forces() const { return lambda_; }

  /// `felt`: as if the plate had been there for a while, so that the first factor knows the
  /// compliance below it.
  void begin(ConjugateGradientDevice* device, SweepDevice* sweeps, bool felt) {
    solver_.set_device(device);
    gauss_seidel_.set_device(sweeps);
    pattern_ = std::make_shared<NodePattern>(nodes(), model_.elastic->pairs());
    step_ = std::make_unique<TissueStep>(model_, solver_, load_, pattern_);
    step_->prepare(context_.dt);
    lambda_.setZero(3 * contacts);
    modes_.assign(contacts, 0);
    if (!felt) return;
    find_contacts();
    for (const Touch& t : touches_) solver_.touch(t.node);
    solver_.renew();
  }

  /// W of the contacts in the first pass of the next step.
  MatX first_compliance() {
    step_->begin(context_);
    find_contacts();
    build();
    force_.setZero(3 * nodes());
    step_->linearise(context_, force_);
    problem_.W.setZero(problem_.rows(), problem_.rows());
    add_tissue_compliance(solver_, problem_.bodies.front(), context_.dt, problem_.W);
    return problem_.W;
  }

  StepCost step() {
    StepCost cost;
    const Clock whole;
    auto stage = linearise;
    auto since = whole;
    const auto enter = [&](Stage next) {
      cost.ms[stage] += since.wall_ms();
      since = Clock();
      stage = next;
    };
    step_->begin(context_);
    find_contacts();
    build();
    const Index most = passes_ > 0 ? passes_ : most_passes;
    for (context_.pass = 0; context_.pass < most && !(cost.solved && passes_ == 0);
         ++context_.pass) {
      BodyRows& rows = problem_.bodies.front();
      enter(linearise);
      force_.setZero(3 * nodes());
      rows.add_transposed(problem_.lambda, force_);
      step_->linearise(context_, force_);
      rows.add_product(context_.dt, step_->change(), problem_.d_free);
      enter(compliance);
      problem_.W.setZero(problem_.rows(), problem_.rows());
      cost.outside += add_tissue_compliance(solver_, rows, context_.dt, problem_.W);
      enter(solve);
      check_.begin(problem_);
      problem_.hold_events = true;
      change_ = -problem_.lambda;
      const SolveReport solved = gauss_seidel_.solve(problem_);
      cost.sweeps += solved.sweeps;
      cost.direct += solved.factorisations;
      change_ += problem_.lambda;
      enter(correct);
      force_.setZero(3 * nodes());
      rows.add_transposed(change_, force_);
      step_->push(context_, force_);
      step_->correct(context_);
      enter(measure);
      lambda_ = problem_.lambda;
      for (std::size_t b = 0; b < modes_.size(); ++b) modes_[b] = problem_.blocks[b].mode;
      build();
      force_.setZero(3 * nodes());
      problem_.bodies.front().add_transposed(problem_.lambda, force_);
      const Real gap = check_.measure(problem_, 1).violation,
                 missing = step_->imbalance(context_, force_).relative;
      cost.solved = gap <= 1e-6 && missing <= 0.01;
    }
    step_->end(context_, force_);
    enter(measure);
    cost.passes = context_.pass;
    cost.iterations = solver_.report().iterations;
    cost.age = solver_.report().factor_age;
    cost.message = solver_.report().message + gauss_seidel_.trouble();
    cost.total = whole.wall_ms();
    context_.time += context_.dt;
    ++context_.step;
    return cost;
  }
  const NodePattern& pattern() const { return *pattern_; }

 private:
  static constexpr Real spacing = 0.0041;  // m, of the points of the plate
  static constexpr Index most_passes = 20;
  struct Touch {
    std::array<Index, 3> node;
    Vec3 weights, start;  // of the point of the tissue; where it was (m)
  };
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  /// Where the plate is at a time: it comes down by 3 mm in 0.1 s, then goes to and fro by 8 mm,
  /// at most at 20 mm/s.
  Vec3 plate(Real time) const {
    const Real down = std::min(time / 0.1, 1.0), gone = std::max(time - 0.1, 0.0);
    return {cell_ * cells_[0] / 2 + 0.008 * std::sin(2.5 * gone), cell_ * cells_[1] / 2,
            top_ - 0.003 * down};
  }
  Index top_node(Index i, Index j) const {
    return (cells_[2] * (cells_[1] + 1) + j) * (cells_[0] + 1) + i;
  }
  Vec3 position(const Touch& t, const VecX& x) const {
    Vec3 out = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k)
      out += t.weights[static_cast<Index>(k)] * x.segment<3>(3 * t.node[k]);
    return out;
  }
  /// The point of the surface that is above these coordinates at rest.
  Touch surface(Real x, Real y) const {
    const Index i = std::clamp(static_cast<Index>(x / cell_), Index{0}, Index{cells_[0] - 1}),
                j = std::clamp(static_cast<Index>(y / cell_), Index{0}, Index{cells_[1] - 1});
    const Real u = x / cell_ - static_cast<Real>(i), v = y / cell_ - static_cast<Real>(j);
    Touch t{};
    t.node = {top_node(i, j), u >= v ? top_node(i + 1, j) : top_node(i, j + 1),
              top_node(i + 1, j + 1)};
    t.weights = {1 - std::max(u, v), std::abs(u - v), std::min(u, v)};
    return t;
  }
  /// Which point of the surface is below each point of the plate as the step begins.
  void find_contacts() {
    touches_.clear();
    const Vec3 now = plate(context_.time);
    for (const Vec3& p : plate_) {
      const Vec3 target = now + p;
      Vec3 rest = target;
      Touch t{};
      for (int k = 0; k < 3; ++k) {
        t = surface(rest.x(), rest.y());
        t.start = position(t, step_->start_positions());
        rest += target - t.start;
      }
      touches_.push_back(t);
    }
  }
  void build() {
    problem_.blocks.clear();
    problem_.params.clear();
    problem_.bodies.resize(1);
    BodyRows& rows = problem_.bodies.front();
    rows.clear();
    const Vec3 before = plate(context_.time), now = plate(context_.end()), moved = now - before;
    static const Vec3 axes[3] = {-Vec3::UnitZ(), Vec3::UnitX(), Vec3::UnitY()};
    gap_.setZero(3 * contacts);
    for (std::size_t c = 0; c < touches_.size(); ++c) {
      const Touch& t = touches_[c];
      test::append<Coulomb>(problem_, {.mu = 0.3}, modes_[c]);
      const Vec3 x = position(t, step_->positions());
      const auto first = static_cast<Index>(3 * c);
      gap_[first] = axes[0].dot(x - now - plate_[c]);
      for (Index k = 1; k < 3; ++k) gap_[first + k] = axes[k].dot(x - t.start - moved);
      for (Index k = 0; k < 3; ++k) {
        rows.row.push_back(first + k);
        for (Index n = 0; n < 3; ++n) {
          rows.node.push_back(t.node[at(n)]);
          for (Index i = 0; i < 3; ++i) rows.value.push_back(t.weights[n] * axes[k][i]);
        }
        rows.start.push_back(static_cast<Index>(rows.node.size()));
      }
    }
    problem_.gap = problem_.d_free = problem_.delta = gap_;
    problem_.lambda = lambda_;
  }

  std::array<int, 3> cells_;
  Real cell_;
  MeshData mesh_;
  Real top_;
  TissueModel model_;
  VecX load_;
  std::shared_ptr<const NodePattern> pattern_;
  AsyncSolver solver_;
  std::unique_ptr<TissueStep> step_;
  BlockGaussSeidel gauss_seidel_;
  LawCheck check_;
  StepContext context_;
  ConstraintProblem problem_;
  std::vector<Vec3> plate_;
  std::vector<Touch> touches_;
  std::vector<Mode> modes_;
  Index passes_ = 0;
  GrowingVec lambda_, change_;
  VecX force_, gap_;
};

}  // namespace sutura::bench
