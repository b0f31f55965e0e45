// The default constraint solver as a component.
#pragma once

#include "solve/gauss_seidel.h"
#include "sutura/describe.h"

namespace sutura {

class GaussSeidel : public Component, public ConstraintSolver {
 public:
  static void describe(Describe<GaussSeidel>& d);
  void initialise(Setup& setup) override;
  void archive(Archive& archive) override;
  SolveReport solve(ConstraintProblem& problem) override;
  std::string trouble() const override { return solver_.trouble(); }

 private:
  Real tolerance_ = 1e-9;
  Index sweeps_ = 1000;
  Index seed_ = 1;
  Acceleration acceleration_ = Acceleration::subspace;
  Link<SweepDevice> device_;
  std::string dump_;
  Index dump_every_ = 0;

  void write_dump(const SolveReport& report);

  std::filesystem::path dump_folder_;
  Index solves_ = 0, failures_ = 0, slowest_ = 0;
  ConstraintProblem before_;  // as it was handed over, while dumping
  BlockGaussSeidel solver_;
  SolveReport last_;
};

}  // namespace sutura
