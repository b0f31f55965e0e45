#include "app/reference.h"
#include "scene/attributes.h"

namespace sutura::app {

namespace {

const char* generated =
    "<!-- Generated from the descriptions in the code: sutura describe --markdown. -->\n\n";

/// Text for a cell of a table.
std::string cell(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out;
}

std::string code(const std::string& text) {
  return text.empty() ? "" : "`" + text + "`";
}

std::string unit_cell(const std::string& unit) {
  return unit.empty() || unit == "1" ? "" : unit;
}

std::string page_link(const std::string& name) {
  return "[" + name + "](" + name + ".md)";
}

void attributes(const ComponentInfo& info, std::string& out) {
  if (info.attributes.empty()) return;
  out +=
      "\n## Attributes\n\n| Name | Type | Unit | Default | Range | Meaning |\n"
      "|---|---|---|---|---|---|\n";
  for (const AttributeInfo& a : info.attributes) {
    const std::string value = a.is_required ? "required" : code(default_text(info, a));
    out += "| " + code(a.name) + " | " + cell(type_text(a, "`")) + " | " + unit_cell(a.unit) +
           " | " + cell(value) + " | " + range_text(a.range, "") + " | " + cell(a.doc) + " |\n";
  }
}

void links(const ComponentInfo& info, const Registry& registry, std::string& out) {
  if (info.links.empty()) return;
  out +=
      "\n## Links\n\n| Name | Leads to | Components that will do | Meaning |\n|---|---|---|---|\n";
  for (const LinkInfo& l : info.links) {
    std::string pages;
    for (const std::string& name : accepted_by(l, registry))
      pages += (pages.empty() ? "" : ", ") + page_link(name);
    out += "| " + code(l.name) + " | " + l.target + (l.is_optional ? " (optional)" : "") + " | " +
           pages + " | " + cell(l.doc) + " |\n";
  }
  out +=
      "\nA link left out means the only component of its kind in reach; see "
      "[scenes](../concepts/scene.md#links).\n";
}

void inputs(const ComponentInfo& info, std::string& out) {
  if (info.inputs.empty()) return;
  out +=
      "\n## Inputs\n\nSet by a host between steps; see [inputs](../concepts/state.md#inputs).\n\n"
      "| Name | Type | Unit | Range | Meaning |\n|---|---|---|---|---|\n";
  for (const InputInfo& i : info.inputs)
    out += "| " + code(i.name) + " | " + (i.is_vector ? "3 reals" : "real") + " | " +
           unit_cell(i.unit) + " | " + range_text(i.range, "") + " | " + cell(i.doc) + " |\n";
}

void outputs(const ComponentInfo& info, std::string& out) {
  if (info.outputs.empty()) return;
  out += "\n## Outputs\n\n| Name | Unit | Meaning |\n|---|---|---|\n";
  for (const OutputInfo& o : info.outputs)
    out += "| " + code(o.name) + " | " + unit_cell(o.unit) + " | " + cell(o.doc) + " |\n";
}

}  // namespace

std::string markdown_page(const ComponentInfo& info, const Registry& registry,
                          const std::string& example) {
  std::string out = generated;
  out += "# " + info.name + "\n\n" + info.summary + "\n\n";
  if (info.plugin == "core")
    out += "Built in; needs no plugin.\n";
  else
    out += "From the plugin `" + info.plugin + "`: `<plugin name=\"" + info.plugin + "\"/>`.\n";
  attributes(info, out);
  links(info, registry, out);
  inputs(info, out);
  outputs(info, out);
  if (!info.theory.empty()) out += "\n## Theory\n\n" + info.theory + "\n";
  if (!example.empty())
    out += "\n## The smallest scene\n\nThis is `scenes/components/" + info.name +
           ".xml`.\n\n```xml\n" + example + (example.ends_with('\n') ? "" : "\n") + "```\n";
  return out;
}

std::string markdown_index(const Registry& registry) {
  std::string out = generated;
  out +=
      "# Components\n\nWhat a scene may contain, by plugin. The same text, in the terminal: "
      "`sutura describe`.\n";
  std::string plugin;
  for (const ComponentInfo* info : registry.components()) {
    if (info->plugin != plugin) out += "\n## " + info->plugin + "\n\n| Component | |\n|---|---|\n";
    plugin = info->plugin;
    out += "| " + page_link(info->name) + " | " + cell(info->summary) + " |\n";
  }
  return out;
}

}  // namespace sutura::app
