// Work against precision of the constraint solvers: natural residual reached after so much time,
// for the synthetic stitches of tests/solve_problems.h and for problems dumped from scenes
// (GaussSeidel dump="...").
//
//   sutura_bench_solver OUT_DIR [FILE.problem ...]
//
// Irreversible events are settled first (by the default solver) and kept, so that all solvers solve
// the same laws. Cold starts at zero force, warm at the forces of the step before (files) or of a
// problem with 5 % other free motion.
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>

#include "../plugins/suturing/cutting_law.h"
#include "../plugins/suturing/puncture_law.h"
#include "solve/gauss_seidel.h"
#include "solve/problem_file.h"
#include "solve/reference_solver.h"
#include "solve_problems.h"
#include "solver_cases.h"
#include "sutura/laws/coulomb.h"
#include "sutura/laws/unilateral.h"

using namespace sutura;

namespace {

struct Point {
  Real milliseconds = 0;
  SolveReport report;
};

/// Best of a few runs; every run starts from the same problem.
Point measure(const ConstraintProblem& start,
              const std::function<SolveReport(ConstraintProblem&)>& solve) {
  Point best;
  Real spent = 0;
  for (int run = 0; run < 5 && (run < 2 || spent < 100); ++run) {
    ConstraintProblem p = start;
    const auto before = std::chrono::steady_clock::now();
    const SolveReport report = solve(p);
    const Real ms =
        std::chrono::duration<Real, std::milli>(std::chrono::steady_clock::now() - before).count();
    spent += ms;
    if (run == 0 || ms < best.milliseconds) best = {ms, report};
  }
  return best;
}

}  // namespace

void sutura::run_case(const Case& c, std::ofstream& csv) {
  struct Solver {
    const char* name;
    bool by_tolerance;  // walk along the curve by tolerance instead of by budget
    std::function<SolveReport(ConstraintProblem&, Index budget, Real tolerance)> solve;
  };
  const auto sweeps = [](Acceleration a) {
    return [a](ConstraintProblem& p, Index budget, Real tolerance) {
      return BlockGaussSeidel({.tolerance = tolerance, .sweeps = budget, .acceleration = a})
          .solve(p);
    };
  };
  const Solver solvers[] = {
      {"Gauss-Seidel", false, sweeps(Acceleration::none)},
      {"NNCG", false, sweeps(Acceleration::nncg)},
      {"Gauss-Seidel + subspace", true, sweeps(Acceleration::subspace)},
      {"ADMM", false,
       [](ConstraintProblem& p, Index budget, Real tolerance) {
         return ReferenceSolver({.tolerance = tolerance, .iterations = budget, .newton = false})
             .solve(p);
       }},
      {"ADMM + Newton", true, [](ConstraintProblem& p, Index budget, Real tolerance) {
         return ReferenceSolver({.tolerance = tolerance, .iterations = budget}).solve(p);
       }}};
  for (const bool warm : {false, true})
    for (const Solver& s : solvers) {
      ConstraintProblem start = c.problem;
      if (warm)
        start.lambda = c.warm;
      else
        start.lambda.setZero();
      Point last;
      for (int k = 0; k < 9; ++k) {
        const Index budget = s.by_tolerance ? 2000 : Index{1} << k * 5 / 4;  // 1 to 1024
        const Real tolerance = s.by_tolerance ? std::pow(10, 1 - k) : 1e-9;
        last = measure(start, [&](ConstraintProblem& p) { return s.solve(p, budget, tolerance); });
        csv << c.name << ',' << c.problem.rows() << ',' << s.name << ',' << (warm ? "warm" : "cold")
            << ',' << last.report.sweeps << ',' << last.report.direct_solves << ','
            << last.milliseconds << ',' << last.report.residual << '\n';
        if (!s.by_tolerance && last.report.converged) break;
        if (last.milliseconds > 500) break;
      }
      std::printf("  %-24s %s  %5td sweeps %3td direct  %9.3f ms  residual %.1e\n", s.name,
                  warm ? "warm" : "cold", last.report.sweeps, last.report.direct_solves,
                  last.milliseconds, last.report.residual);
    }
}

Case sutura::settle(std::string name, ConstraintProblem problem) {
  Case c{std::move(name), std::move(problem), {}};
  c.warm = c.problem.lambda;
  ConstraintProblem solved = c.problem;
  BlockGaussSeidel().solve(solved);
  for (std::size_t i = 0; i < solved.blocks.size(); ++i)
    c.problem.blocks[i].mode = solved.blocks[i].mode;
  return c;
}

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: sutura_bench_solver OUT_DIR [FILE.problem ...]\n");
    return 1;
  }
  const std::filesystem::path out = argv[1];
  std::filesystem::create_directories(out);
  if (!bench_scenes(out)) return 3;
  std::vector<Case> cases;
  for (const int samples : {20, 50, 150})
    for (const Real pull : {0.05, 0.3, 3.0}) {
      const test::StitchOptions options{.samples = samples, .pull = pull};
      ConstraintProblem p = test::stitch(options), other = p;
      other.d_free *= 1.05;
      BlockGaussSeidel().solve(other);
      p.lambda = other.lambda;
      char name[64];
      std::snprintf(name, sizeof(name), "synthetic %d samples %.2f N", samples, pull);
      cases.push_back(settle(name, std::move(p)));
    }
  const LawOperations* const laws[] = {&law_operations<Bilateral<1>>,
                                       &law_operations<Bilateral<2>>,
                                       &law_operations<Bilateral<3>>,
                                       &law_operations<Bilateral<6>>,
                                       &law_operations<Unilateral>,
                                       &law_operations<Coulomb>,
                                       &law_operations<suturing::PunctureLaw>,
                                       &law_operations<suturing::PathFrictionLaw>,
                                       &law_operations<suturing::CuttingLaw>};
  for (int i = 2; i < argc; ++i) {
    ConstraintProblem p;
    if (const std::string error = read_problem(argv[i], laws, p); !error.empty()) {
      std::fprintf(stderr, "%s\n", error.c_str());
      return 3;
    }
    cases.push_back(settle(std::filesystem::path(argv[i]).stem().string(), std::move(p)));
  }
  std::ofstream csv(out / "solver.csv");
  csv << case_columns;
  for (const Case& c : cases) {
    std::printf("%s (%td rows)\n", c.name.c_str(), c.problem.rows());
    run_case(c, csv);
  }
  return csv ? 0 : 3;
}
