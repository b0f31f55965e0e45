// A constraint problem on disk, to look at a failing or slow one again. Binary, for the machine and
// build that wrote it: parameters of laws are stored as bytes and checked by law name and size.
#pragma once

#include <span>
#include <string>

#include "sutura/constraints.h"

namespace sutura {

/// Empty, or what went wrong.
std::string write_problem(const ConstraintProblem& problem, const std::string& file);

/// `laws`: those that may occur, as Registry::laws() lists them. `problem.bodies` stays empty.
std::string read_problem(const std::string& file, std::span<const LawOperations* const> laws,
                         ConstraintProblem& problem);

}  // namespace sutura
