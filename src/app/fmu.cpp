// `sutura fmu`: a scene, the files it reads, its plugins and every library behind them in one file.
#include <dlfcn.h>
#include <link.h>

#include <cstdio>
#include <fstream>
#include <map>
#include <span>
#include <sstream>

#include "app/commands.h"
#include "app/fmu_description.h"
#include "app/zip.h"
#include "runtime/checkpoint_file.h"
#include "sutura/describe.h"
#include "sutura/sutura.h"

namespace sutura::app {

namespace fs = std::filesystem;

namespace {

/// Everything in the file: name in it and contents.
using Contents = std::map<std::string, std::string>;

bool read_into(Contents& contents, const std::string& name, const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) {
    complain("cannot read " + file.string());
    return false;
  }
  contents[name] = std::move(text).str();
  return true;
}

/// On every machine that can run the rest: the C and C++ libraries, and what the kernel brings.
bool is_system_library(const std::string& name) {
  for (const char* start : {"linux-vdso.so", "ld-linux", "libc.so", "libm.so", "libdl.so",
                            "libpthread.so", "librt.so", "libgcc_s.so", "libstdc++.so"})
    if (name.starts_with(start)) return true;
  return false;
}

/// Files of the shared libraries that this process has loaded.
std::vector<fs::path> loaded_libraries() {
  std::vector<fs::path> out;
  dl_iterate_phdr(
      [](dl_phdr_info* info, std::size_t, void* list) {
        if (info->dlpi_name != nullptr && *info->dlpi_name != 0)
          static_cast<std::vector<fs::path>*>(list)->emplace_back(info->dlpi_name);
        return 0;
      },
      &out);
  return out;
}

/// The libraries of this run, as they lie beside each other: plugins in the folder `sutura`.
bool add_libraries(Contents& contents, const std::string& folder, const std::string& identifier) {
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&sutura_api), &info) == 0) return false;
  const fs::path beside = fs::path(info.dli_fname).parent_path();
  for (const fs::path& file : loaded_libraries()) {
    const std::string name = file.filename().string();
    if (is_system_library(name)) continue;
    const bool is_plugin = name.starts_with("libsutura_");
    if (!read_into(contents, folder + (is_plugin ? "sutura/" : "") + name, file)) return false;
  }
  return read_into(contents, folder + identifier + ".so", beside / "sutura_fmu.so");
}

/// Puts the files that the scene reads into `contents`; returns settings by which it finds them
/// there.
bool add_files(Contents& contents, const Scene& scene, LoadOptions& options) {
  std::size_t number = 0;
  for (Component* c : scene.components())
    for (const AttributeInfo& a : c->info().attributes) {
      if (a.type != AttributeType::file) continue;
      const std::string& path = static_cast<File*>(a.member(*c))->path;
      if (path.empty()) continue;
      const std::string name =
          "files/" + std::to_string(++number) + '_' + fs::path(path).filename().string();
      if (!read_into(contents, "resources/" + name, scene.file.parent_path() / path)) return false;
      options.overrides.emplace_back(c->path() + '.' + a.name, name);
    }
  return true;
}

bool write(const Contents& contents, const fs::path& file) {
  std::ostringstream out;
  Zip zip(out);
  for (const auto& [name, data] : contents) zip.add(name, data);
  if (!zip.finish()) {
    complain("cannot write " + file.string() + ": its contents are too large for a zip file");
    return false;
  }
  std::error_code ignored;
  if (file.has_parent_path() && !fs::is_directory(file.parent_path(), ignored)) {
    complain("cannot write " + file.string() + ": its folder does not exist");
    return false;
  }
  const std::string bytes = std::move(out).str();
  const std::string problem = replace_file(file, std::as_bytes(std::span(bytes)));
  if (!problem.empty()) complain(problem);
  return problem.empty();
}

}  // namespace

int fmu(const FmuArguments& arguments) {
  LoadOptions options;
  if (!load_options(arguments.scene, options)) return usage;
  const fs::path scene_file = arguments.scene.scene;
  const std::string name = scene_file.stem().string();
  const fs::path file =
      arguments.output.empty() ? fs::path(name + ".fmu") : fs::path(arguments.output);
  constexpr int file_problem = static_cast<int>(Category::file);

  // What the FMU holds is the scene with all settings, and with its files in a folder beside it.
  Registry registry;
  enrol_builtin(registry);
  Diagnostics diagnostics;
  std::unique_ptr<Scene> scene = load_scene(scene_file, registry, diagnostics, options);
  if (!scene) return report(diagnostics);
  Contents contents;
  if (!add_files(contents, *scene, options)) return file_problem;
  const std::unique_ptr<Scene> packed = load_scene(scene_file, registry, diagnostics, options);
  if (!packed) return report(diagnostics);
  contents["resources/scene.xml"] = write_scene(*packed);

  // The scene is made ready once, to see that it stands and what it loads.
  const auto simulation =
      Simulation::compile(std::move(scene), {}, diagnostics, arguments.scene.allow_outside);
  report(diagnostics);
  if (!simulation) return diagnostics.exit_code();
  contents["modelDescription.xml"] = model_description(*simulation, name);
  if (!add_libraries(contents, "binaries/x86_64-linux/", model_identifier(name)))
    return file_problem;
  if (!write(contents, file)) return file_problem;
  std::printf("%s: %zu files\n", file.string().c_str(), contents.size());
  return ok;
}

}  // namespace sutura::app
