// The commands behind `sutura`. Each returns an exit code (docs/command.md).
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sutura/scene.h"

namespace sutura::app {

enum ExitCode { ok = 0, usage = 1, diverged = 4, inaccurate = 5, internal = 70, interrupted = 130 };

/// What `run` and `check` share.
struct SceneArguments {
  std::string scene;
  std::vector<std::string> settings;  ///< "path.attribute=value"
  std::vector<std::string> plugin_directories;
  bool allow_outside = false;  ///< files outside of the output folder
};

struct RunArguments {
  SceneArguments scene;
  std::optional<Index> steps;
  std::string duration;          ///< "4 s"; empty: not given
  std::string output;            ///< folder; empty: out/NAME
  std::string checkpoint_every;  ///< "1 s"; empty: no checkpoints
  std::string resume;            ///< file of a state; empty: from the beginning
  bool lenient = false;          ///< a run that misses its tolerances ends with 0 all the same
};

struct DescribeArguments {
  std::string component;  ///< empty: all
  bool xsd = false;
  bool devices = false;
  std::string markdown;                      ///< folder to write pages to; empty: none
  std::string scenes = "scenes/components";  ///< folder of NAME.xml, shown as examples
  std::vector<std::string> plugin_directories;
};

struct FmuArguments {
  SceneArguments scene;
  std::string output;  ///< file; empty: NAME.fmu in the current folder
};

int run(const RunArguments& arguments);
int check(const SceneArguments& arguments);
int describe(const DescribeArguments& arguments);
int fmu(const FmuArguments& arguments);

/// Prints every diagnostic to standard error and returns the exit code.
int report(const Diagnostics& diagnostics);
/// Prints "sutura: message" to standard error.
void complain(const std::string& message);
/// False, after a complaint, if a setting is not of the form path.attribute=value.
bool load_options(const SceneArguments& arguments, LoadOptions& options);

}  // namespace sutura::app
