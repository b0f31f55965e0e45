// The solvers of a tissue as components of a scene.
#pragma once

#include <string>

#include "async_solver.h"
#include "direct_solver.h"
#include "sutura/component.h"
#include "sutura/describe.h"

namespace sutura::tissue {

enum class BackendChoice { automatic, cholmod, eigen };

class DirectSolver : public Component, public SynchronousSolver {
 public:
  BackendChoice backend = BackendChoice::automatic;

  static void describe(Describe<DirectSolver>& d);
  void initialise(Setup& setup) override;
  void archive(Archive& archive) override { SynchronousSolver::archive(archive); }
};

class AsyncPreconditioner : public Component, public AsyncSolver {
 public:
  std::string lag = "free";
  Real tolerance = 1e-4;
  Index max_iterations = 200;
  Index refactor_iterations = 2;
  Index max_age = 200;
  BackendChoice backend = BackendChoice::automatic;
  Link<ConjugateGradientDevice> device;

  static void describe(Describe<AsyncPreconditioner>& d);
  void initialise(Setup& setup) override;
  void archive(Archive& archive) override { AsyncSolver::archive(archive); }
};

}  // namespace sutura::tissue
