#include "app/reference.h"

#include <algorithm>

#include "scene/attributes.h"

namespace sutura::app {

std::string type_text(const AttributeInfo& a, const char* quote) {
  switch (a.type) {
    case AttributeType::real:
      return "real";
    case AttributeType::integer:
      return "whole number";
    case AttributeType::flag:
      return "true or false";
    case AttributeType::text:
      return "text";
    case AttributeType::file:
      return "file";
    case AttributeType::vec3:
      return "3 reals";
    case AttributeType::reals:
      return "list of reals";
    case AttributeType::choice:
      break;
  }
  std::string out;
  for (std::size_t i = 0; i < a.choices.size(); ++i) {
    if (i > 0) out += i + 1 == a.choices.size() ? " or " : ", ";
    out += quote + a.choices[i] + quote;
  }
  return out;
}

std::string default_text(const ComponentInfo& info, const AttributeInfo& attribute) {
  if (attribute.is_required) return {};
  return write_attribute(attribute, *info.create());
}

std::vector<std::string> accepted_by(const LinkInfo& link, const Registry& registry) {
  std::vector<std::string> out;
  for (const ComponentInfo* info : registry.components())
    if (link.accepts(*info->create())) out.push_back(info->name);
  return out;
}

namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : ", ") + word;
  return out;
}

/// Up to the first full stop or colon: what fits on a line.
std::string first_clause(const std::string& text) {
  const std::size_t end = std::min(text.find(". "), text.find(": "));
  return end == std::string::npos ? text : text.substr(0, end) + '.';
}

std::string units_of(const std::string& unit) {
  return unit == "1" ? "-" : unit;
}

}  // namespace

std::string plain_text(const ComponentInfo& info, const Registry& registry) {
  std::string out = info.name + " (plugin " + info.plugin + ")\n  " + info.summary + "\n";
  if (!info.attributes.empty()) out += "\nAttributes\n";
  for (const AttributeInfo& a : info.attributes) {
    out += "  " + a.name + ": " + type_text(a, "'");
    const std::string range = range_text(a.range, a.unit);
    if (!range.empty())
      out += " " + range;
    else if (!a.unit.empty() && a.unit != "1")
      out += " in " + a.unit;
    const std::string value = default_text(info, a);
    if (a.is_required)
      out += "; required";
    else if (!value.empty())
      out += "; default " + value;
    out += "\n      " + a.doc + "\n";
  }
  if (!info.links.empty()) out += "\nLinks\n";
  for (const LinkInfo& l : info.links)
    out += "  " + l.name + ": " + l.target + " (" + joined(accepted_by(l, registry)) + ")" +
           (l.is_optional ? "; optional" : "") + "\n      " + l.doc + "\n";
  if (!info.inputs.empty()) out += "\nInputs, set by a host between steps\n";
  for (const InputInfo& i : info.inputs) {
    const std::string range = range_text(i.range, i.unit);
    out += "  " + i.name + ": " + (i.is_vector ? "3 reals" : "real") +
           (range.empty() ? " in " + units_of(i.unit) : " " + range) + "\n      " + i.doc + "\n";
  }
  if (!info.outputs.empty()) out += "\nOutputs\n";
  for (const OutputInfo& o : info.outputs)
    out += "  " + o.name + (o.unit.empty() ? "" : " [" + units_of(o.unit) + "]") + "\n      " +
           o.doc + "\n";
  if (!info.theory.empty()) out += "\nTheory\n" + info.theory + "\n";
  return out;
}

std::string plain_index(const Registry& registry) {
  std::string out, plugin;
  for (const ComponentInfo* info : registry.components()) {
    if (info->plugin != plugin || out.empty())
      out += (out.empty() ? "" : "\n") + info->plugin + '\n';
    plugin = info->plugin;
    out += "  " + info->name;
    out.append(info->name.size() < 18 ? 18 - info->name.size() : 1, ' ');
    out += first_clause(info->summary) + '\n';
  }
  return out;
}

}  // namespace sutura::app
