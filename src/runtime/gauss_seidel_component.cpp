#include "runtime/gauss_seidel_component.h"

#include "sutura/laws/bilateral.h"
#include "sutura/laws/coulomb.h"
#include "sutura/laws/unilateral.h"
#include "sutura/registry.h"

namespace sutura {

void GaussSeidel::describe(Describe<GaussSeidel>& d) {
  d.summary(
      "Solves the constraints of a step: block Gauss-Seidel, warm-started, with a direct step over the rows whose state "
      "is settled. The default solver of a scene that names none.");
  d.theory(
      "delta = W lambda + d_free and one law per block. The law residual is the largest change that any law still asks "
      "for, in units of its block (0.1 N and 0.1 mm unless the source says otherwise). Irreversible events (a puncture, "
      "a break-away) fire only on converged forces, all at once, and the solve goes on. See docs/theory/solver.md.");
  d.attribute("tolerance", &GaussSeidel::tolerance_, "1",
              {.low = 0, .high = 1e-3, .low_open = true},
              "Law residual at which the solve stops; at most 1e-3, where events would fire on transient forces.");
  d.attribute("sweeps", &GaussSeidel::sweeps_, at_least(1),
              "Budget: sweeps over all blocks in one solve.");
  d.attribute("seed", &GaussSeidel::seed_, at_least(0), "Seed of the order of blocks.");
  d.attribute("acceleration", &GaussSeidel::acceleration_, {"none", "nncg", "subspace"},
              "What helps the sweeps: nothing, nonlinear conjugate gradients, or the direct step.");
  d.output("sweeps", "1", "Sweeps of the last step.",
           [](const GaussSeidel& s) { return Real(s.last_.sweeps); });
  d.output("direct_solves", "1", "Direct steps of the last step.",
           [](const GaussSeidel& s) { return Real(s.last_.direct_solves); });
  d.output("residual", "1", "Law residual left, in units of the blocks.",
           [](const GaussSeidel& s) { return s.last_.residual; });
  d.output("violation", "m", "Largest distance of a block from its law.",
           [](const GaussSeidel& s) { return s.last_.violation; });
}

void GaussSeidel::initialise(Setup&) {
  solver_.options() = {.tolerance = tolerance_,
                       .sweeps = sweeps_,
                       .seed = static_cast<std::uint64_t>(seed_),
                       .acceleration = acceleration_};
}

SolveReport GaussSeidel::solve(ConstraintProblem& problem) {
  last_ = solver_.solve(problem);
  return last_;
}

void enrol_builtin(Registry& registry) {
  registry.component<GaussSeidel>("GaussSeidel");
  registry.law<Bilateral<1>>();
  registry.law<Bilateral<2>>();
  registry.law<Bilateral<3>>();
  registry.law<Bilateral<6>>();
  registry.law<Unilateral>();
  registry.law<Coulomb>();
}

}  // namespace sutura
