#include "scene/reader.h"

#include <algorithm>

#include "scene/attributes.h"
#include "scene/builder.h"
#include "sutura/plugin.h"
#include "sutura/text.h"
#include "sutura/units.h"

namespace sutura {
namespace {

const std::vector<std::string> settings{
    "version",        "dt",     "gravity",  "duration",  "tolerance", "gap_tolerance",
    "time_tolerance", "passes", "substeps", "time_order"};
const std::vector<std::string> only_name{"name"};
constexpr Range dt_range{.low = 1e-9, .high = 1e4};        // s
constexpr Range duration_range{.low = 0, .high = 1e6};     // s: eleven days
constexpr Range tolerance_range{.low = 1e-12, .high = 1};  // of lengths: m

}  // namespace

std::string child_path(const std::string& parent, const std::string& name) {
  return parent == "/" ? parent + name : parent + '/' + name;
}

SceneReader::SceneReader(Scene& scene, Registry& registry, Diagnostics& diagnostics,
                         const LoadOptions& options, std::string file)
    : scene_(scene), registry_(registry), diagnostics_(diagnostics), file_(std::move(file)) {
  plugin_directories_ = options.plugin_directories;
  for (std::string& directory : default_plugin_directories())
    plugin_directories_.push_back(std::move(directory));
  take_overrides(options);
}

void SceneReader::error(SourceLocation where, const std::string& path, std::string message) {
  diagnostics_.error(std::move(where), path, std::move(message));
}

void SceneReader::take_overrides(const LoadOptions& options) {
  for (const auto& [target, value] : options.overrides) {
    const std::size_t dot = target.rfind('.');
    Override o;
    o.path = target.substr(0, std::min(dot, target.size()));
    if (o.path.empty()) o.path = "/";
    if (dot != std::string::npos) o.attribute = target.substr(dot + 1);
    o.value = value;
    if (o.attribute.empty() || o.path.front() != '/') {
      error({"--set " + shortened(target), 0}, "",
            "expected '/path/of/component.attribute=value', or '.dt=value' for a setting of the "
            "scene");
      continue;
    }
    // Given twice, the last one holds, as on any command line.
    std::erase_if(overrides_, [&](const Override& other) {
      return other.path == o.path && other.attribute == o.attribute;
    });
    overrides_.push_back(std::move(o));
  }
}

void SceneReader::report_unused_overrides() {
  std::vector<std::string> paths;
  for (const auto& [path, names] : attribute_names_) paths.push_back(path);
  for (const Override& o : overrides_) {
    if (o.used || failed_.contains(o.path)) continue;
    const std::string target = o.path == "/" ? "" : o.path;
    const SourceLocation where{"--set " + shortened(target + '.' + o.attribute), 0};
    const auto component = attribute_names_.find(o.path);
    if (component == attribute_names_.end())
      error(where, "",
            "the scene has no component " + shortened(o.path) + did_you_mean(o.path, paths));
    else
      error(where, o.path == "/" ? "" : o.path,
            "there is no attribute '" + shortened(o.attribute) + "'" +
                did_you_mean(o.attribute, component->second));
  }
}

std::vector<SceneReader::Value> SceneReader::values_of(const XmlElement& element,
                                                       const std::string& path) {
  std::vector<Value> values;
  for (const XmlAttribute& a : element.attributes) values.push_back({a.name, a.value, at(a.line)});
  for (Override& o : overrides_) {
    if (o.path != path || o.attribute == "name" || o.attribute == "version") continue;
    const auto same = std::find_if(values.begin(), values.end(),
                                   [&](const Value& v) { return v.name == o.attribute; });
    const std::string target = path == "/" ? "" : path;
    Value value{o.attribute, o.value, {"--set " + shortened(target + '.' + o.attribute), 0}};
    if (same != values.end())
      *same = std::move(value);
    else
      values.push_back(std::move(value));
  }
  return values;
}

void SceneReader::reject_text(const XmlElement& element, const std::string& path) {
  if (element.text_line > 0)
    error(at(element.text_line), path,
          "text inside <" + shortened(element.name) + ">; a scene says everything in attributes");
}

void SceneReader::reject_children(const XmlElement& element, const std::string& path) {
  for (const XmlElement& child : element.children)
    error(at(child.line), path,
          "<" + shortened(child.name) + "> inside <" + shortened(element.name) +
              ">, which takes no elements; group components with <node>");
}

void SceneReader::read(const XmlElement& root) {
  if (root.name != "sutura") {
    error(at(root.line), "",
          "the root element is <" + shortened(root.name) + ">; expected <sutura version=\"1\">");
    return;
  }
  scene_.root.path = "/";
  scene_.root.location = at(root.line);
  read_settings(root);
  reject_text(root, "");
  read_plugins(root);
  read_children(root, scene_.root);
  report_unused_overrides();
}

void SceneReader::read_settings(const XmlElement& root) {
  attribute_names_["/"].assign(settings.begin() + 1, settings.end());
  bool has_version = false;
  for (const Value& value : values_of(root, "/")) {
    std::string why;
    const auto complain = [&](const std::string& message) {
      error(value.location, "", value.name + ": " + message);
    };
    const auto read = [&](Real& out, const std::string& unit, const Range& range) {
      const std::optional<Real> number = parse_quantity(value.text, unit, why);
      if (!number) return complain(why);
      if (!range.contains(*number))
        return complain(in_quotes(value.text) + " is out of range: it must be " +
                        range_text(range, unit));
      out = *number;
    };
    const auto read_count = [&](Index& out, Real most, bool power_of_two) {
      Real number = static_cast<Real>(out);
      read(number, "1", {.low = 1, .high = most});
      const auto whole = static_cast<Index>(number);
      if (static_cast<Real>(whole) != number || (power_of_two && (whole & (whole - 1)) != 0))
        return complain(in_quotes(value.text) + ": expected a whole number" +
                        (power_of_two ? " that is a power of two" : ""));
      out = whole;
    };
    if (value.name == "version") {
      has_version = true;
      if (value.text != "1")
        complain(in_quotes(value.text) + " is not supported; this program reads version 1");
    } else if (value.name == "dt") {
      read(scene_.dt, "s", dt_range);
      if (scene_.dt > 0.2)  // s; from 1 to 20 ms as a rule
        diagnostics_.warning(value.location, "",
                             "dt is " + format_real(scene_.dt) + " s; is the unit right?");
    } else if (value.name == "duration") {
      read(scene_.duration, "s", duration_range);
    } else if (value.name == "tolerance") {
      read(scene_.limits.tolerance, "1", tolerance_range);
    } else if (value.name == "gap_tolerance") {
      read(scene_.limits.gap_tolerance, "m", tolerance_range);
    } else if (value.name == "time_tolerance") {
      read(scene_.limits.time_tolerance, "m", Range{.low = 0, .high = 1});
    } else if (value.name == "passes") {
      read_count(scene_.limits.passes, 1024, false);
    } else if (value.name == "substeps") {
      read_count(scene_.limits.substeps, 1024, true);
    } else if (value.name == "time_order") {
      read_count(scene_.limits.time_order, 2, false);
    } else if (value.name == "gravity") {
      const auto g = parse_quantities(value.text, "m/s^2", why);
      if (g && g->size() == 3)
        scene_.gravity = Vec3((*g)[0], (*g)[1], (*g)[2]);
      else
        complain(g ? in_quotes(value.text) + ": expected 3 numbers" : why);
    } else if (value.location.line > 0) {  // else it is said better with the other --set errors
      error(value.location, "",
            "<sutura> has no attribute '" + shortened(value.name) + "'" +
                did_you_mean(value.name, settings));
    }
  }
  for (Override& o : overrides_)
    if (o.path == "/")
      o.used = std::find(settings.begin() + 1, settings.end(), o.attribute) != settings.end();
  if (!has_version) error(at(root.line), "", "<sutura> needs version=\"1\"");
}

void SceneReader::read_plugins(const XmlElement& root) {
  for (const XmlElement& element : root.children) {
    if (element.name != "plugin") continue;
    reject_text(element, "");
    reject_children(element, "");
    const XmlAttribute* name = nullptr;
    for (const XmlAttribute& a : element.attributes) {
      if (a.name == "name")
        name = &a;
      else
        error(at(a.line), "",
              "<plugin> has no attribute '" + shortened(a.name) + "', only 'name'" +
                  did_you_mean(a.name, only_name));
    }
    if (!name) {
      error(at(element.line), "", "<plugin> needs a name, as in <plugin name=\"thread\"/>");
      all_plugins_loaded_ = false;
      continue;
    }
    const auto same = [&](const PluginUse& use) { return use.name == name->value; };
    if (std::any_of(scene_.plugins.begin(), scene_.plugins.end(), same)) {
      error(at(name->line), "", "the plugin '" + shortened(name->value) + "' is named twice");
      continue;
    }
    scene_.plugins.push_back({name->value, at(name->line)});
    if (!load_plugin(registry_, name->value, plugin_directories_, at(name->line), diagnostics_))
      all_plugins_loaded_ = false;
  }
}

void SceneReader::read_children(const XmlElement& element, Node& node) {
  std::set<std::string> names;
  for (const XmlElement& child : element.children) {
    if (child.name == "node") {
      read_node(child, node, names);
    } else if (child.name == "plugin") {
      if (node.parent)
        error(at(child.line), node.path, "<plugin> stands directly below <sutura>, not in a node");
    } else {
      read_component(child, node, names);
    }
  }
}

std::string SceneReader::name_of(const XmlElement& element, const std::string& fallback,
                                 const Node& parent, std::set<std::string>& names) {
  const auto given = std::find_if(element.attributes.begin(), element.attributes.end(),
                                  [](const XmlAttribute& a) { return a.name == "name"; });
  const bool is_given = given != element.attributes.end();
  const std::string& name = is_given ? given->value : fallback;
  const int line = is_given ? given->line : element.line;
  const std::string where = parent.parent ? parent.path : std::string();
  if (!is_given && fallback.empty()) {
    error(at(line), where, "<" + shortened(element.name) + "> needs a name");
    return {};
  }
  if (!is_name(name)) {
    error(at(line), where,
          in_quotes(name) + " cannot be a name: a letter, then letters, digits, '_' and '-' only");
    return {};
  }
  if (!names.insert(name).second) {
    error(at(line), where,
          "the name '" + shortened(name) +
              "' is taken by a sibling; say name=\"...\" for one of them");
    return {};
  }
  return name;
}

void SceneReader::read_node(const XmlElement& element, Node& parent, std::set<std::string>& names) {
  const std::string name = name_of(element, "", parent, names);
  auto node = std::make_unique<Node>();
  node->name = name.empty() ? "?" : name;
  node->path = child_path(parent.path, node->name);
  node->location = at(element.line);
  node->parent = &parent;
  for (const XmlAttribute& a : element.attributes)
    if (a.name != "name")
      error(at(a.line), node->path,
            "<node> has no attribute '" + shortened(a.name) + "', only 'name'" +
                did_you_mean(a.name, only_name));
  reject_text(element, node->path);
  if (name.empty()) failed_.insert(node->path);
  parent.children.push_back(std::move(node));
  read_children(element, *parent.children.back());
}

void SceneReader::read_component(const XmlElement& element, Node& node,
                                 std::set<std::string>& names) {
  const std::string name = name_of(element, default_name(element.name), node, names);
  const std::string path = child_path(node.path, name.empty() ? "?" : name);
  reject_text(element, path);
  reject_children(element, path);
  const ComponentInfo* info = registry_.find(element.name);
  if (!info) {
    unknown_component(element, node.parent ? node.path : std::string());
    failed_.insert(path);
    return;
  }
  const auto is_its_plugin = [&](const PluginUse& use) { return use.name == info->plugin; };
  if (info->plugin != "core" &&
      std::none_of(scene_.plugins.begin(), scene_.plugins.end(), is_its_plugin))
    error(at(element.line), path,
          "<" + info->name +
              "> comes from a plugin that the scene does not name; add <plugin name=\"" +
              info->plugin + "\"/>");
  Component& component =
      SceneBuilder::append(scene_, node, SceneBuilder::create(*info, name, path, at(element.line)));
  if (name.empty()) failed_.insert(path);

  std::vector<std::string>& known = attribute_names_[path];
  for (const AttributeInfo& a : info->attributes) known.push_back(a.name);
  for (const LinkInfo& l : info->links) known.push_back(l.name);
  for (Override& o : overrides_)
    if (o.path == path) o.used = std::find(known.begin(), known.end(), o.attribute) != known.end();

  read_values(element, component, node, values_of(element, path));
}

void SceneReader::read_values(const XmlElement& element, Component& component, Node& node,
                              const std::vector<Value>& values) {
  const ComponentInfo& info = component.info();
  const auto find = [&](const std::string& name) {
    return std::find_if(values.begin(), values.end(),
                        [&](const Value& v) { return v.name == name; });
  };
  for (const AttributeInfo& a : info.attributes) {
    const auto value = find(a.name);
    if (value == values.end()) {
      if (a.is_required)
        error(at(element.line), component.path(),
              "<" + info.name + "> needs the attribute '" + a.name + "'");
      continue;
    }
    SceneBuilder::note(component, a.name);
    std::string why;
    if (!read_attribute(a, component, value->text, why))
      error(value->location, component.path(), a.name + ": " + why);
  }
  for (std::size_t i = 0; i < info.links.size(); ++i) {
    const auto value = find(info.links[i].name);
    const bool given = value != values.end();
    if (given && value->text.empty()) {
      error(value->location, component.path(), info.links[i].name + ": the path is empty");
      continue;
    }
    links_.push_back({&component, &node, i, given ? value->text : std::string(),
                      given ? value->location : at(element.line)});
  }
  const std::vector<std::string>& known = attribute_names_[component.path()];
  for (const Value& value : values) {
    if (value.name == "name" || std::find(known.begin(), known.end(), value.name) != known.end())
      continue;
    if (value.location.line == 0) continue;  // reported as an unused --set
    std::vector<std::string> candidates = known;
    candidates.push_back("name");
    const std::string meant = did_you_mean(value.name, candidates);
    error(value.location, component.path(),
          "<" + info.name + "> has no attribute '" + shortened(value.name) + "'" +
              (meant.empty() ? "; 'sutura describe " + info.name + "' lists what it has" : meant));
  }
}

}  // namespace sutura
