// The default constraint solver as a component.
#pragma once

#include "solve/gauss_seidel.h"
#include "sutura/describe.h"

namespace sutura {

class GaussSeidel : public Component, public ConstraintSolver {
 public:
  static void describe(Describe<GaussSeidel>& d);
  void initialise(Setup& setup) override;
  SolveReport solve(ConstraintProblem& problem) override;

 private:
  Real tolerance_ = 1e-5;
  Index sweeps_ = 1000;
  Index seed_ = 1;
  Acceleration acceleration_ = Acceleration::subspace;
  BlockGaussSeidel solver_;
  SolveReport last_;
};

}  // namespace sutura
