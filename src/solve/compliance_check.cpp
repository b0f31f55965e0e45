#include "solve/compliance_check.h"

namespace sutura {

Real compliance_error(std::span<const Body* const> bodies, const ConstraintProblem& problem,
                      const VecX& d_free, Real dt, VecX& error) {
  error = d_free - problem.delta;
  MatX column;
  VecX force;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (problem.bodies[i].size() == 0) continue;
    force.setZero(bodies[i]->dofs());
    problem.bodies[i].add_transposed(problem.lambda, force);
    if (force.isZero(0)) continue;
    column = dt * force;  // as `correct` will ask: a body may remember the answer
    bodies[i]->solve(column);
    force = dt * column.col(0);
    problem.bodies[i].add_product(force, error);
  }
  return error.size() > 0 ? error.cwiseAbs().maxCoeff() : 0;
}

}  // namespace sutura
