// What is said when a component does what it must not do: throw, or make more rows than fit.
#pragma once

#include <string>

#include "sutura/component.h"
#include "sutura/constraints.h"
#include "sutura/simulation.h"

namespace sutura {

/// Rows that a step may hold. The compliance W is a dense matrix and the direct step makes another
/// one of up to its size: at 4096 rows they take 134 MB each.
inline constexpr Index most_rows = 4096;

/// Of a step with more than `most_rows` rows. The diagnostic names the component with most of them.
struct TooManyRows {
  Diagnostic diagnostic;
};

/// Throws TooManyRows if the problem has more rows than a step may hold.
void check_rows(const ConstraintProblem& problem, const Scene& scene);

/// To be called in a `catch (...)`: what to say of the exception. `who` was at work, or nullptr if
/// that was no component; `when`: "while it was initialised".
Diagnostic failure_of(const Component* who, const std::string& when);
/// The same where a component was at work in that stage of a step.
Diagnostic failure_in_step(const Component* who, Stage stage, Index step);

}  // namespace sutura
