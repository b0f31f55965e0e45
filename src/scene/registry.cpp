#include "sutura/registry.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <tuple>

namespace sutura {

const ComponentInfo* Registry::find(const std::string& name) const {
  const auto found = components_.find(name);
  return found == components_.end() ? nullptr : found->second.get();
}

std::vector<const ComponentInfo*> Registry::components() const {
  std::vector<const ComponentInfo*> all;
  all.reserve(components_.size());
  for (const auto& [name, info] : components_) all.push_back(info.get());
  std::sort(all.begin(), all.end(), [](const ComponentInfo* a, const ComponentInfo* b) {
    return std::tie(a->plugin, a->name) < std::tie(b->plugin, b->name);
  });
  return all;
}

bool Registry::has_plugin(const std::string& name) const {
  return std::find(plugins_.begin(), plugins_.end(), name) != plugins_.end();
}

void Registry::end_plugin() {
  for (const auto& [name, info] : components_)
    if (info->plugin == plugin_) check_names(*info);
  plugins_.push_back(std::move(plugin_));
  plugin_ = "core";
}

/// What a scene can never say, because of the name it was given.
void Registry::check_names(const ComponentInfo& info) {
  const auto complain = [&](const std::string& what, const std::string& why) {
    clashes_.push_back("plugin '" + plugin_ + "' describes '" + what + "' of " + info.name + ", " +
                       why);
  };
  const auto check = [&](std::set<std::string>& known, const std::string& name) {
    const auto is_fit = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; };
    if (name.empty() || !std::all_of(name.begin(), name.end(), is_fit))
      complain(name, "which is no name: expected letters, digits and '_'");
    else if (name == "name")
      complain(name, "which every component has");
    else if (!known.insert(name).second)
      complain(name, "twice");
  };
  std::set<std::string> attributes, outputs, inputs;
  for (const AttributeInfo& a : info.attributes) check(attributes, a.name);
  for (const LinkInfo& l : info.links) check(attributes, l.name);
  for (const OutputInfo& o : info.outputs) check(outputs, o.name);
  for (const InputInfo& i : info.inputs) check(inputs, i.name);
}

ComponentInfo& Registry::add_component(const std::string& name) {
  auto info = std::make_unique<ComponentInfo>();
  info->name = name;
  info->plugin = plugin_;
  auto& place = components_[name];
  if (!place) {
    place = std::move(info);
    return *place;
  }
  clashes_.push_back("plugin '" + plugin_ + "' offers the component " + name + ", which plugin '" +
                     place->plugin + "' has already");
  refused_.push_back(std::move(info));
  return *refused_.back();
}

void Registry::add_law(const LawOperations* law) {
  for (const LawOperations* known : laws_) {
    if (known == law) return;
    if (std::string_view(known->name) != law->name) continue;
    clashes_.push_back("plugin '" + plugin_ + "' offers the law " + law->name +
                       ", which exists already");
    return;
  }
  laws_.push_back(law);
}

}  // namespace sutura
