// What the parts of the solver bench share: a problem with a start, and its race of solvers.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "sutura/constraints.h"

namespace sutura {

struct Case {
  std::string name;
  ConstraintProblem problem;  // modes settled
  VecX warm;
};

/// Modes settled by the default solver; warm is the lambda that the problem came with.
Case settle(std::string name, ConstraintProblem problem);

inline constexpr const char* case_columns =
    "problem,rows,solver,start,sweeps,direct solves,time ms,residual\n";
/// All solvers, cold and warm: rows of `case_columns`.
void run_case(const Case& c, std::ofstream& csv);

/// Runs scenes of scenes/, takes problems out of them and writes solver_scenes.csv.
bool bench_scenes(const std::filesystem::path& out);

}  // namespace sutura
