// Part of the solver bench: the compliance of a thread, assembled and as an operator.
#pragma once

#include <filesystem>

namespace sutura {

/// Writes solver_compliance.csv: set-up, sweep and direct step for threads of 200, 1000 and 5000
/// beams.
bool bench_compliance(const std::filesystem::path& out);

}  // namespace sutura
