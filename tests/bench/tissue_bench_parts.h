// The parts of sutura_bench_tissue that measure solvers; each appends its table to a CSV in
// `folder`.
#pragma once

#include <string>

namespace sutura::bench {

/// tissue_steps.csv: ms per step of a pad under a moving tool, by size and solver.
void tissue_steps(const std::string& folder, bool large);
/// tissue_age.csv: PCG iterations against what happened since the factor was made.
void tissue_age(const std::string& folder);
/// tissue_compliance.csv: W of 300 surface nodes, from the candidates and by multi-column solves.
void tissue_compliance(const std::string& folder);
/// tissue_cure.csv: error and cost of the element types in bending and indentation.
void tissue_cure(const std::string& folder);

}  // namespace sutura::bench
