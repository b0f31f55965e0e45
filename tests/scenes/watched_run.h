// Runs a scene in-process with a solver that shows every problem as it was handed over and as it
// came out.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>

#include "solve/gauss_seidel.h"
#include "sutura/describe.h"
#include "sutura/plugin.h"
#include "sutura/simulation.h"

namespace sutura::testing {

/// The default solver, and a look at what it does, once in every pass.
class WatchedSolver : public Component, public ConstraintSolver {
 public:
  using Look = std::function<void(const ConstraintProblem& before, const ConstraintProblem& after,
                                  const SolveReport&)>;
  static void describe(Describe<WatchedSolver>& d) {
    d.summary("The default solver, watched by a test.");
    d.attribute("tolerance", &WatchedSolver::tolerance, "1", above(0), "As that of GaussSeidel.");
  }
  SolveReport solve(ConstraintProblem& problem) override {
    if (look) before_ = problem;
    solver_.options().tolerance = tolerance;
    const SolveReport report = solver_.solve(problem);
    if (look) look(before_, problem, report);
    return report;
  }
  Look look;
  Real tolerance = GaussSeidelOptions{}.tolerance;

 private:
  BlockGaussSeidel solver_;
  ConstraintProblem before_;
};

/// The first and the last solve of a step.
struct WatchedStep {
  ConstraintProblem first, before, after;
  bool any = false;

  void look(const ConstraintProblem& from, const ConstraintProblem& to) {
    if (!any) first = from;
    any = true;
    before = from;
    after = to;
  }
  /// The last problem with every block in the state in which it began the step, and its events
  /// free to fire.
  ConstraintProblem start() const {
    ConstraintProblem p = before;
    p.hold_events = false;
    for (ConstraintBlock& b : p.blocks)
      for (const ConstraintBlock& old : first.blocks)
        if (old.key == b.key) b.mode = old.mode;
    return p;
  }
};

class WatchedRun {
 public:
  /// The scene names a WatchedSolver, if anybody wants to watch. `any_size` takes away the ranges
  /// of attributes, which are those of real needles and tissue: for scenes in other units.
  explicit WatchedRun(const std::filesystem::path& file, const LoadOptions& more = {},
                      bool any_size = false) {
    enrol_builtin(registry_);
    if (any_size) lift_ranges();
    registry_.component<WatchedSolver>("WatchedSolver");
    LoadOptions options = more;
    options.plugin_directories = {SUTURA_BINARY_DIR "/lib/sutura"};
    Diagnostics diagnostics;
    auto scene = load_scene(file, registry_, diagnostics, options);
    if (scene) simulation_ = Simulation::compile(std::move(scene), ".", diagnostics);
    if (!simulation_)
      for (const Diagnostic& d : diagnostics.all()) ADD_FAILURE() << d.text();
  }
  explicit operator bool() const { return simulation_ != nullptr; }
  Simulation& simulation() { return *simulation_; }
  WatchedSolver& solver() {
    return dynamic_cast<WatchedSolver&>(*simulation_->find("/watched_solver"));
  }

  /// The only body with this interface.
  template <class T>
  T& body() {
    for (const auto& b : simulation_->bodies())
      if (auto* t = dynamic_cast<T*>(b.body)) return *t;
    throw std::logic_error("no such body");
  }
  Real output(const std::string& path, const std::string& name) {
    const Component* c = simulation_->find(path);
    for (const OutputInfo& o : c->info().outputs)
      if (o.name == name) return std::get<Real>(o.read(*c));
    throw std::logic_error("no output " + path + "." + name);
  }

 private:
  void lift_ranges() {
    const std::vector<std::string> folders{SUTURA_BINARY_DIR "/lib/sutura"};
    Diagnostics diagnostics;
    for (const std::string& name : available_plugins(folders))
      load_plugin(registry_, name, folders, {}, diagnostics);
    for (const ComponentInfo* info : registry_.components())
      for (AttributeInfo& a : const_cast<ComponentInfo*>(info)->attributes)
        if (!a.unit.empty()) a.range = any();
  }

  Registry registry_;
  std::unique_ptr<Simulation> simulation_;
};

}  // namespace sutura::testing
