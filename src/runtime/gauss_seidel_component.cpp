#include "runtime/gauss_seidel_component.h"

#include "solve/problem_file.h"
#include "sutura/archive.h"
#include "sutura/laws/bilateral.h"
#include "sutura/laws/coulomb.h"
#include "sutura/laws/turning_force.h"
#include "sutura/laws/unilateral.h"
#include "sutura/registry.h"

namespace sutura {

void GaussSeidel::describe(Describe<GaussSeidel>& d) {
  d.summary(
      "Solves the constraints of a step: block Gauss-Seidel, warm-started, with a direct step over "
      "all forces that may change. The default solver of a scene that names none.");
  d.theory(
      "delta = W lambda + d_free and one law per block. The law residual is the largest change "
      "that any law still asks for, in units of its block (0.1 N and 0.1 mm unless the source says "
      "otherwise). Events (a puncture, a break-away) wait until the end of the step has been "
      "measured. See docs/theory/solver.md.");
  d.attribute("tolerance", &GaussSeidel::tolerance_, "1",
              {.low = 0, .high = 1e-3, .low_open = true},
              "Law residual at which the solve stops; a thousand times that, of the residual with "
              "which it begins, is enough for a pass of a step.");
  d.attribute("sweeps", &GaussSeidel::sweeps_, between(1, 1000000),
              "Budget: sweeps over all blocks in one solve.");
  d.attribute("seed", &GaussSeidel::seed_, at_least(0), "Seed of the order of blocks.");
  d.attribute("acceleration", &GaussSeidel::acceleration_, {"none", "nncg", "subspace"},
              "What helps the sweeps: nothing, nonlinear conjugate gradients, or the direct step.");
  d.attribute("dump", &GaussSeidel::dump_,
              "Folder, under the output folder, for problems to be replayed by the solver bench: "
              "every one that does not "
              "converge (at most 100) and the slowest so far; empty: none.");
  d.attribute("dump_every", &GaussSeidel::dump_every_, at_least(0),
              "With `dump`: also every so many solves; 0: none.");
  d.link(
       "device", &GaussSeidel::device_,
       "Sweeps and large direct steps are made there instead of on the CPU; everything else of the "
       "solve stays. For hundreds of blocks, see docs/theory/opencl.md.")
      .named_only();
  d.output("sweeps", "1", "Sweeps of the last step.",
           [](const GaussSeidel& s) { return Real(s.last_.sweeps); });
  d.output("direct_solves", "1", "Direct steps of the last step.",
           [](const GaussSeidel& s) { return Real(s.last_.direct_solves); });
  d.output("residual", "1", "Law residual left, in units of the blocks.",
           [](const GaussSeidel& s) { return s.last_.residual; });
  d.output("violation", "m", "Largest distance of a block from its law.",
           [](const GaussSeidel& s) { return s.last_.violation; });
}

void GaussSeidel::initialise(Setup& setup) {
  solver_.options() = {.tolerance = tolerance_,
                       .sweeps = sweeps_,
                       .seed = static_cast<std::uint64_t>(seed_),
                       .acceleration = acceleration_};
  solver_.set_device(device_.get());
  if (device_ && acceleration_ == Acceleration::nncg)
    setup.error(*this,
                "acceleration=\"nncg\" works on the CPU alone; use \"subspace\" or \"none\" with a "
                "device");
  if (dump_.empty())
    return setup.warn_without_effect(*this, {"dump_every"}, "'dump' names no folder");
  if (const auto place = setup.output(*this, "dump", dump_, "*.problem")) dump_folder_ = *place;
}

/// The order of blocks is seeded anew in every solve and is no state.
void GaussSeidel::archive(Archive& a) {
  a("solves", solves_);
  a("failures", failures_);
  a("slowest", slowest_);
  a("sweeps", last_.sweeps);
  a("direct_solves", last_.direct_solves);
  a("residual", last_.residual);
  a("violation", last_.violation);
}

SolveReport GaussSeidel::solve(ConstraintProblem& problem) {
  if (!dump_.empty()) before_ = problem;
  last_ = solver_.solve(problem);
  if (!dump_.empty()) write_dump(last_);
  ++solves_;
  return last_;
}

void GaussSeidel::write_dump(const SolveReport& report) {
  std::error_code ignored;
  std::filesystem::create_directories(dump_folder_, ignored);
  const auto write = [this](const std::string& name) {
    write_problem(before_, (dump_folder_ / (name + ".problem")).string());
  };
  if (!report.converged && failures_++ < 100) write("failed_" + std::to_string(solves_));
  if (dump_every_ > 0 && solves_ % dump_every_ == 0) write("step_" + std::to_string(solves_));
  // A direct step counts as ten sweeps.
  const Index cost = report.sweeps + 10 * report.direct_solves;
  if (cost > slowest_) {
    slowest_ = cost;
    write("slowest");
  }
}

void enrol_builtin(Registry& registry) {
  registry.component<GaussSeidel>("GaussSeidel");
  registry.law<Bilateral<1>>();
  registry.law<Bilateral<2>>();
  registry.law<Bilateral<3>>();
  registry.law<Bilateral<6>>();
  registry.law<TurningForce>();
  registry.law<Unilateral>();
  registry.law<Coulomb>();
}

}  // namespace sutura
