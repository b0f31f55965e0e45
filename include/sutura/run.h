// A scene from its first step to its last, as `sutura run` does it: recording, saving the state now
// and then, going on from a saved one.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sutura/diagnostics.h"
#include "sutura/scene.h"
#include "sutura/simulation.h"

namespace sutura {

struct RunOptions {
  std::filesystem::path output = {};  ///< folder of the recorders
  /// The last step, or the end in simulated time (s), counted from the beginning of the scene, also
  /// when the run goes on from a state. Neither: the duration that the scene gives.
  std::optional<Index> steps = {};
  std::optional<Real> duration = {};
  /// Simulated time between two states written to `checkpoint_file(output)` (s); 0: none.
  Real checkpoint_every = 0;
  std::filesystem::path resume = {};  ///< a state to go on from; empty: from the beginning
  bool allow_outside = false;         ///< the scene may name files outside of `output`
};

/// The only file of states in a folder: each one replaces the one before.
std::filesystem::path checkpoint_file(const std::filesystem::path& output);

/// How a run ended.
enum class RunEnd {
  done,
  stopped,      ///< by the observer
  diverged,     ///< the state is no longer finite
  failed,       ///< StepReport::failure, which is among the diagnostics
  file_failed,  ///< a recorder or a checkpoint could not be written, a state not be restored
  no_end,       ///< nobody says how long
  refused       ///< the scene does not compile: see the diagnostics
};

struct RunResult {
  RunEnd end = RunEnd::done;
  std::string message;  ///< what went wrong, a sentence; empty if nothing did
  Index first = 0;      ///< steps that were done before, by the run that saved the state
  Index last = 0;       ///< step reached
  Index steps = 0;      ///< step at which it is done
  double seconds = 0;   ///< wall time of the steps
  std::vector<std::string> notes = {};  ///< of a run that is done (EndNote): "path: sentence"
};

/// Looks on, after every step; may set inputs. The run ends if it returns false.
using RunObserver = std::function<bool(Simulation&, const StepReport&, const RunResult& so_far)>;

/// Never throws for what a scene or a file may hold. Recorders are closed in any case.
RunResult run_scene(std::unique_ptr<Scene> scene, const RunOptions& options,
                    Diagnostics& diagnostics, const RunObserver& observer = {});

}  // namespace sutura
