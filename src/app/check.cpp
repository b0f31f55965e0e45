#include <algorithm>
#include <cstdio>

#include "app/commands.h"
#include "sutura/simulation.h"

namespace sutura::app {

int report(const Diagnostics& diagnostics) {
  constexpr std::size_t most = 100;
  const auto all = diagnostics.all();
  for (const Diagnostic& d : all.first(std::min(all.size(), most)))
    std::fprintf(stderr, "%s\n", d.text().c_str());
  if (all.size() > most) std::fprintf(stderr, "... and %zu more\n", all.size() - most);
  return diagnostics.exit_code();
}

void complain(const std::string& message) {
  std::fprintf(stderr, "sutura: %s\n", message.c_str());
}

bool load_options(const SceneArguments& arguments, LoadOptions& options) {
  options.plugin_directories = arguments.plugin_directories;
  for (const std::string& setting : arguments.settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos) {
      complain("--set " + setting + ": expected PATH.ATTRIBUTE=VALUE");
      return false;
    }
    options.overrides.emplace_back(setting.substr(0, equals), setting.substr(equals + 1));
  }
  return true;
}

int check(const SceneArguments& arguments) {
  LoadOptions options;
  if (!load_options(arguments, options)) return usage;
  Registry registry;
  enrol_builtin(registry);
  Diagnostics diagnostics;
  std::unique_ptr<Scene> scene = load_scene(arguments.scene, registry, diagnostics, options);
  if (!scene) return report(diagnostics);
  const std::size_t components = scene->components().size();
  // Files are read by the components themselves when they are initialised.
  const auto simulation =
      Simulation::compile(std::move(scene), {}, diagnostics, arguments.allow_outside);
  if (!simulation) return report(diagnostics);
  report(diagnostics);  // warnings
  const std::size_t bodies = simulation->bodies().size();
  std::printf("%s: ok, %zu component%s, %zu bod%s\n", arguments.scene.c_str(), components,
              components == 1 ? "" : "s", bodies, bodies == 1 ? "y" : "ies");
  return ok;
}

}  // namespace sutura::app
