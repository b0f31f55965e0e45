// What is said of an element that is no component of the scene's plugins.
#include "base/nearest_name.h"
#include "scene/reader.h"
#include "sutura/plugin.h"
#include "sutura/text.h"

namespace sutura {

/// Components of the plugins that the scene does not name, with their plugins.
const std::map<std::string, std::string>& SceneReader::elsewhere() {
  if (looked_elsewhere_) return elsewhere_;
  looked_elsewhere_ = true;
  for (const std::string& name : available_plugins(plugin_directories_)) {
    if (registry_.has_plugin(name)) continue;
    Registry other;
    Diagnostics ignored;
    load_plugin(other, name, plugin_directories_, {}, ignored);
    for (const ComponentInfo* info : other.components()) elsewhere_[info->name] = name;
  }
  return elsewhere_;
}

void SceneReader::unknown_component(const XmlElement& element, const std::string& path) {
  if (!all_plugins_loaded_) return;  // it may well come from the plugin that is missing
  std::vector<std::string> tags{"node", "plugin"}, others;
  for (const ComponentInfo* info : registry_.components()) tags.push_back(info->name);
  for (const auto& [tag, plugin] : elsewhere()) others.push_back(tag);
  const auto found = elsewhere().find(element.name);
  if (found != elsewhere().end()) {
    error(at(element.line), path,
          "<" + element.name +
              "> comes from a plugin that the scene does not name; add <plugin name=\"" +
              found->second + "\"/>");
    return;
  }
  std::string message = "there is no component <" + shortened(element.name) + ">";
  const std::string instead = what_instead(element.name);
  const std::string near = nearest_name(element.name, tags);
  const std::string other = other_word(element.name, others);
  if (!instead.empty()) {
    message += "; " + instead;
  } else if (!near.empty()) {
    message += "; did you mean <" + near + ">?";
  } else if (!other.empty()) {
    message += "; did you mean <" + other + "> of the plugin '" + elsewhere().at(other) + "'?";
  } else if (scene_.plugins.empty()) {
    message += "; the scene names no plugin";
  } else {
    message += " in the plugins of this scene (";
    for (const PluginUse& use : scene_.plugins)
      message += (&use == &scene_.plugins.front() ? "" : ", ") + shortened(use.name);
    message += ")";
  }
  error(at(element.line), path, message);
}

}  // namespace sutura
