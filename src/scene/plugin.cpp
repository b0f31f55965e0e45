#include "sutura/plugin.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <filesystem>

#include "scene/plugin_file.h"
#include "sutura/text.h"

namespace sutura {

namespace fs = std::filesystem;

namespace {

/// The name becomes part of a file name and of a symbol.
bool is_plugin_name(const std::string& name) {
  constexpr std::size_t longest = 64;
  return !name.empty() && name.size() <= longest &&
         std::all_of(name.begin(), name.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
         });
}

constexpr std::string_view file_prefix = "libsutura_";
constexpr std::string_view file_suffix = ".so";

std::string not_found(const std::string& name, const std::vector<std::string>& directories) {
  std::string out = "plugin '" + name + "' is in none of the folders searched";
  const std::string near = nearest_name(name, available_plugins(directories));
  if (!near.empty()) out += "; did you mean '" + near + "'?";
  out += directories.empty() ? " (there are none)" : " (";
  for (std::size_t i = 0; i < directories.size(); ++i)
    out += directories[i] + (i + 1 < directories.size() ? ", " : ")");
  return out;
}

/// Calls enrol and says what went wrong with it, or nothing.
std::string enrol(Registry& registry, const PluginHeader& header) {
  const std::size_t clashes_before = registry.clashes().size();
  std::string problem;
  registry.begin_plugin(header.name);
  try {
    header.enrol(registry);
  } catch (const std::exception& e) {
    problem = "plugin '" + std::string(header.name) + "' failed while enrolling: " + e.what();
  } catch (...) {
    problem = "plugin '" + std::string(header.name) + "' failed while enrolling";
  }
  registry.end_plugin();
  if (problem.empty() && registry.clashes().size() > clashes_before)
    problem = registry.clashes()[clashes_before];
  return problem;
}

}  // namespace

std::string check_plugin(const PluginHeader& header, const std::string& expected_name) {
  const std::string who = "plugin '" + expected_name + "' ";
  if (header.struct_size != sizeof(PluginHeader))
    return who + "was built with another header of " + std::to_string(header.struct_size) +
           " bytes; expected " + std::to_string(sizeof(PluginHeader));
  if (header.abi != SUTURA_ABI)
    return who + "was built for ABI " + std::to_string(header.abi) + "; this library has ABI " +
           std::to_string(SUTURA_ABI);
  if (!header.build_tag || std::string_view(header.build_tag) != SUTURA_BUILD_TAG)
    return who + "was built as '" + (header.build_tag ? header.build_tag : "") +
           "'; this library as '" + SUTURA_BUILD_TAG + "'";
  if (!header.name || header.name != expected_name)
    return who + "calls itself '" + (header.name ? header.name : "") + "'";
  if (!header.version || !*header.version) return who + "gives no version";
  if (!header.licence || !*header.licence) return who + "gives no licence";
  if (!header.enrol) return who + "has no enrol function";
  return {};
}

bool load_plugin(Registry& registry, const std::string& name,
                 const std::vector<std::string>& directories, const SourceLocation& where,
                 Diagnostics& diagnostics) {
  const auto fail = [&](std::string message) {
    diagnostics.error(where, "", std::move(message), Category::plugin);
    return false;
  };
  if (registry.has_plugin(name)) return true;
  if (!is_plugin_name(name))
    return fail(in_quotes(name) +
                " cannot be the name of a plugin: lower case letters, digits and '_' only");

  for (const std::string& directory : directories) {
    const fs::path file =
        fs::path(directory) / (std::string(file_prefix) + name + std::string(file_suffix));
    std::error_code ignored;
    if (!fs::exists(file, ignored)) continue;
    if (const std::string wrong = check_plugin_file(file); !wrong.empty())
      return fail("plugin '" + name + "' cannot be loaded: " + file.string() + ' ' + wrong);
    // Never closed once enrolled: the registry holds functions that live in it.
    void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!library) {
      const char* why = dlerror();
      return fail("plugin '" + name + "' cannot be loaded: " + (why ? why : file.string()));
    }
    using Entry = const PluginHeader* (*)();
    const std::string symbol = "sutura_plugin_" + name;
    const auto entry = reinterpret_cast<Entry>(dlsym(library, symbol.c_str()));
    const PluginHeader* header = entry ? entry() : nullptr;
    std::string problem;
    if (!header)
      problem = "plugin '" + name + "' exports no " + symbol + " (" + file.string() + ")";
    else
      problem = check_plugin(*header, name);
    if (!problem.empty()) {
      dlclose(library);
      return fail(problem);
    }
    problem = enrol(registry, *header);
    return problem.empty() || fail(problem);
  }
  return fail(not_found(name, directories));
}

bool enrol_plugin(Registry& registry, const PluginHeader& header, Diagnostics& diagnostics) {
  const std::string name = header.struct_size == sizeof(PluginHeader) && header.name
                               ? header.name
                               : std::string("(static)");
  std::string problem = check_plugin(header, name);
  if (problem.empty() && registry.has_plugin(name)) return true;
  if (problem.empty()) problem = enrol(registry, header);
  if (problem.empty()) return true;
  diagnostics.error({}, "", problem, Category::plugin);
  return false;
}

std::vector<std::string> default_plugin_directories() {
  std::vector<std::string> out;
  if (const char* variable = std::getenv("SUTURA_PLUGIN_PATH")) {
    std::string_view rest = variable;
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find(':'), rest.size());
      if (end > 0) out.emplace_back(rest.substr(0, end));
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }
  // Plugins lie in the folder `sutura` beside the library, built or installed.
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&check_plugin), &info) && info.dli_fname)
    out.push_back((fs::path(info.dli_fname).parent_path() / "sutura").lexically_normal().string());
  return out;
}

std::vector<std::string> available_plugins(const std::vector<std::string>& directories) {
  std::vector<std::string> names;
  for (const std::string& directory : directories) {
    std::error_code ignored;
    for (fs::directory_iterator i(directory, ignored), end; i != end; i.increment(ignored)) {
      const std::string file = i->path().filename().string();
      if (file.starts_with(file_prefix) && file.ends_with(file_suffix))
        names.push_back(
            file.substr(file_prefix.size(), file.size() - file_prefix.size() - file_suffix.size()));
    }
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

}  // namespace sutura
