// Problems out of our own scenes, taken while they run: as they were handed to the solver, with the
// forces of the step before.
#include <cstdio>
#include <sstream>
#include <vector>

#include "solve/gauss_seidel.h"
#include "solver_cases.h"
#include "sutura/describe.h"
#include "sutura/simulation.h"

namespace sutura {
namespace {

/// The default solver, with a look at the problem before.
class CapturingSolver : public Component, public ConstraintSolver {
 public:
  static void describe(Describe<CapturingSolver>& d) {
    d.summary("The default solver, for the bench.");
  }
  SolveReport solve(ConstraintProblem& problem) override {
    if (capture && !taken) {
      taken = true;
      before = problem;
      before.bodies.clear();
    }
    return solver_.solve(problem);
  }
  bool capture = false, taken = false;
  ConstraintProblem before;

 private:
  BlockGaussSeidel solver_;
};

struct Moment {
  const char* name;
  Real time;  // s
};
struct SceneCases {
  const char* file;
  std::vector<Moment> moments;
};

const SceneCases scenes[] = {
    {"suture/first_stitch.xml", {{"stitch: needle cutting", 1.0}, {"stitch: thread sliding", 4.0}}},
    {"validation/tensioned_thread.xml", {{"tensioned thread", 2.1}}},
    {"validation/three_bites.xml",
     {{"two bites: needle cutting", 6.2},
      {"two bites: thread sliding", 8.6},
      {"three bites: thread sliding", 13.3}}}};

bool take(const SceneCases& from, std::vector<Case>& cases) {
  const std::filesystem::path file =
      std::filesystem::path(SUTURA_SOURCE_DIR) / "scenes" / from.file;
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  std::string xml = text.str();
  xml.insert(xml.rfind("</sutura>"), "<CapturingSolver/>");
  Registry registry;
  enrol_builtin(registry);
  registry.component<CapturingSolver>("CapturingSolver");
  Diagnostics diagnostics;
  auto scene = load_scene_text(xml, file.string(), file.parent_path(), registry, diagnostics);
  const auto simulation = scene ? Simulation::compile(std::move(scene), ".", diagnostics) : nullptr;
  for (const Diagnostic& d : diagnostics.all()) std::fprintf(stderr, "%s\n", d.text().c_str());
  if (!simulation) return false;
  auto& solver = dynamic_cast<CapturingSolver&>(*simulation->find("/capturing_solver"));
  for (const Moment& m : from.moments) {
    while (simulation->time() < m.time - 1e-9) simulation->step();
    solver.capture = true;
    solver.taken = false;
    simulation->step();
    solver.capture = false;
    if (solver.taken) cases.push_back(settle(m.name, solver.before));
  }
  // Laws live in the plugins, which stay loaded.
  return true;
}

}  // namespace

bool bench_scenes(const std::filesystem::path& out) {
  std::ofstream csv(out / "solver_scenes.csv");
  csv << case_columns;
  for (const SceneCases& s : scenes) {
    std::vector<Case> cases;
    if (!take(s, cases)) return false;
    for (const Case& c : cases) {
      std::printf("%s (%td rows)\n", c.name.c_str(), c.problem.rows());
      run_case(c, csv);
    }
  }
  return static_cast<bool>(csv);
}

}  // namespace sutura
