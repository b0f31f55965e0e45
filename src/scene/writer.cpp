// A scene as XML that loads to the same scene.
#include <algorithm>
#include <map>

#include "scene/attributes.h"
#include "scene/builder.h"
#include "sutura/text.h"
#include "sutura/units.h"

namespace sutura {

namespace {

class Writer {
 public:
  explicit Writer(const Scene& scene) : scene_(scene) {
    const std::vector<Component*> order = scene.components();
    for (std::size_t i = 0; i < order.size(); ++i) position_[order[i]] = i;
  }

  std::string write() {
    const Scene defaults;
    out_ = "<sutura";
    attribute("version", "1");
    attribute("dt", format_real(scene_.dt) + " s");
    if (scene_.duration != defaults.duration)
      attribute("duration", format_real(scene_.duration) + " s");
    const StepLimits& limits = scene_.limits;
    if (limits.tolerance != defaults.limits.tolerance)
      attribute("tolerance", format_real(limits.tolerance));
    if (limits.gap_tolerance != defaults.limits.gap_tolerance)
      attribute("gap_tolerance", format_real(limits.gap_tolerance) + " m");
    if (limits.time_tolerance != defaults.limits.time_tolerance)
      attribute("time_tolerance", format_real(limits.time_tolerance) + " m");
    if (limits.passes != defaults.limits.passes) attribute("passes", std::to_string(limits.passes));
    if (limits.substeps != defaults.limits.substeps)
      attribute("substeps", std::to_string(limits.substeps));
    if (limits.time_order != defaults.limits.time_order)
      attribute("time_order", std::to_string(limits.time_order));
    attribute("gravity", format_real(scene_.gravity.x()) + ' ' + format_real(scene_.gravity.y()) +
                             ' ' + format_real(scene_.gravity.z()));
    out_ += ">\n";
    for (const PluginUse& use : scene_.plugins) {
      out_ += "  <plugin";
      attribute("name", use.name);
      out_ += "/>\n";
    }
    contents(scene_.root, "  ");
    out_ += "</sutura>\n";
    return std::move(out_);
  }

 private:
  void attribute(const std::string& name, const std::string& value) {
    out_ += ' ' + name + "=\"" + xml_escaped(value) + '"';
  }

  /// Position of the first component at or below `node`; nodes without any come last.
  std::size_t first_position(const Node& node) const {
    std::size_t first = position_.size();
    for (const auto& c : node.components) first = std::min(first, position_.at(c.get()));
    for (const auto& child : node.children) first = std::min(first, first_position(*child));
    return first;
  }

  /// Components and child nodes in the order of the document: constraint rows follow it.
  void contents(const Node& node, const std::string& indent) {
    auto component = node.components.begin();
    auto child = node.children.begin();
    while (component != node.components.end() || child != node.children.end()) {
      const bool child_first = child != node.children.end() &&
                               (component == node.components.end() ||
                                first_position(**child) < position_.at(component->get()));
      if (child_first) {
        out_ += indent + "<node";
        attribute("name", (*child)->name);
        out_ += ">\n";
        contents(**child++, indent + "  ");
        out_ += indent + "</node>\n";
      } else {
        write_component(**component++, indent);
      }
    }
  }

  void write_component(const Component& c, const std::string& indent) {
    const ComponentInfo& info = c.info();
    out_ += indent + '<' + info.name;
    if (c.name() != default_name(info.name)) attribute("name", c.name());
    const std::unique_ptr<Component> fresh = info.create();
    for (const AttributeInfo& a : info.attributes) {
      const std::string text = write_attribute(a, c);
      if (a.is_required || c.says(a.name) || text != write_attribute(a, *fresh))
        attribute(a.name, text);
    }
    const std::vector<Component*>& targets = SceneBuilder::slots(scene_, c);
    for (std::size_t i = 0; i < targets.size(); ++i)
      if (targets[i]) attribute(info.links[i].name, targets[i]->path());
    out_ += "/>\n";
  }

  const Scene& scene_;
  std::map<const Component*, std::size_t> position_;
  std::string out_;
};

}  // namespace

std::string write_scene(const Scene& scene) {
  return Writer(scene).write();
}

}  // namespace sutura
