// Steps of one body without constraints, in passes as src/runtime/step.cpp makes them.
#pragma once

#include "sutura/body.h"

namespace sutura::test {

/// What a step alone may take, and how well it must balance.
struct Alone {
  Real tolerance = 1e-9;
  Index passes = 50;
};

/// One step under `force` (N, N m; size dofs); returns the passes, 0 if they did not do. Allocates
/// nothing itself.
inline Index step_alone(Body& body, StepContext context, const VecX& force,
                        const Alone& limits = {}) {
  body.begin_step(context);
  bool balanced = false;
  while (!balanced && context.pass < limits.passes) {
    body.linearise(context, force);
    body.correct(context);
    ++context.pass;
    balanced = context.pass >= body.least_passes() &&
               body.imbalance(context, force).relative <= limits.tolerance;
  }
  body.end_step(context, force);
  return balanced ? context.pass : 0;
}

inline Index step_alone(Body& body, const StepContext& context, const Alone& limits = {}) {
  return step_alone(body, context, VecX::Zero(body.dofs()), limits);
}

}  // namespace sutura::test
