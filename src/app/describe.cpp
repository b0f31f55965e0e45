#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "app/commands.h"
#include "app/reference.h"
#include "sutura/plugin.h"

namespace sutura::app {

namespace fs = std::filesystem;

namespace {

/// Everything that is found. A plugin that does not load is reported and left out.
void load_all(Registry& registry, const std::vector<std::string>& first, Diagnostics& diagnostics) {
  enrol_builtin(registry);
  std::vector<std::string> directories = first;
  for (std::string& d : default_plugin_directories()) directories.push_back(std::move(d));
  for (const std::string& name : available_plugins(directories))
    load_plugin(registry, name, directories, {}, diagnostics);
}

std::string read_text(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  if (stream) text << stream.rdbuf();
  return text.str();
}

bool write_text(const fs::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) complain("cannot write " + file.string());
  return static_cast<bool>(stream);
}

int write_markdown(const Registry& registry, const DescribeArguments& arguments) {
  const fs::path folder = arguments.markdown;
  std::error_code code;
  fs::create_directories(folder, code);
  if (!write_text(folder / "index.md", markdown_index(registry)))
    return static_cast<int>(Category::file);
  for (const ComponentInfo* info : registry.components()) {
    if (!arguments.component.empty() && info->name != arguments.component) continue;
    const std::string example = read_text(fs::path(arguments.scenes) / (info->name + ".xml"));
    if (!write_text(folder / (info->name + ".md"), markdown_page(*info, registry, example)))
      return static_cast<int>(Category::file);
  }
  return ok;
}

void print(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
}

}  // namespace

int describe(const DescribeArguments& arguments) {
  Registry registry;
  Diagnostics diagnostics;
  load_all(registry, arguments.plugin_directories, diagnostics);
  const int plugin_code = report(diagnostics);

  if (!arguments.component.empty() && !registry.find(arguments.component)) {
    std::vector<std::string> names;
    for (const ComponentInfo* info : registry.components()) names.push_back(info->name);
    const std::string near = nearest_name(arguments.component, names);
    complain("there is no component " + arguments.component +
             (near.empty() ? "" : "; did you mean " + near + "?"));
    return usage;
  }
  if (!arguments.markdown.empty()) {
    const int code = write_markdown(registry, arguments);
    return code != ok ? code : plugin_code;
  }
  if (arguments.devices) {
    for (const auto& list : registry.devices()) print(list());
    if (registry.devices().empty()) print("no plugin that uses devices is found\n");
    return plugin_code;
  }
  if (arguments.xsd)
    print(xml_schema(registry));
  else if (arguments.component.empty())
    print(plain_index(registry));
  else
    print(plain_text(*registry.find(arguments.component), registry));
  return plugin_code;
}

}  // namespace sutura::app
