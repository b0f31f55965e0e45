#include "app/fmu_description.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "base/unit_expression.h"
#include "sutura/describe.h"
#include "sutura/text.h"
#include "sutura/units.h"

namespace sutura::app {
namespace {

/// "/tools/holder" and "force" -> "tools.holder.force".
std::string variable_name(const Component& component, const std::string& name) {
  std::string out = component.path().substr(1) + '.' + name;
  std::replace(out.begin(), out.end(), '/', '.');
  std::replace(out.begin(), out.end(), '-', '_');
  return out;
}

std::string attribute(const std::string& name, const std::string& value) {
  return ' ' + name + "=\"" + xml_escaped(value) + '"';
}

/// Variables, and what of them are outputs.
class Description {
 public:
  explicit Description(const Simulation& simulation) {
    add("Float64", "time", "independent", "continuous", "s", "Simulated time.", "");
    for (Component* c : simulation.scene().components())
      for (const InputInfo& i : c->info().inputs) add_input(*c, i);
    for (Component* c : simulation.scene().components())
      for (const OutputInfo& o : c->info().outputs) add_output(*c, o);
  }

  std::string variables() const { return variables_; }
  std::string units() const {
    std::string out;
    for (const auto& [unit, exponents] : units_)
      out += "    <Unit" + attribute("name", unit) + "><BaseUnit" + exponents + "/></Unit>\n";
    return out;
  }
  std::string structure() const {
    std::string out;
    for (const char* element : {"Output", "InitialUnknown"})
      for (const std::size_t reference : outputs_)
        out += std::string("    <") + element +
               attribute("valueReference", std::to_string(reference)) + "/>\n";
    return out;
  }

 private:
  void add(const std::string& type, const std::string& name, const std::string& causality,
           const std::string& variability, const std::string& unit, const std::string& doc,
           const std::string& more) {
    variables_ += "    <" + type + attribute("name", name) +
                  attribute("valueReference", std::to_string(count_++)) +
                  attribute("description", doc) + attribute("causality", causality) +
                  attribute("variability", variability);
    if (!unit.empty() && unit != "1") {
      variables_ += attribute("unit", unit);
      note(unit);
    }
    variables_ += more + "/>\n";
  }
  /// Remembers the unit as exponents of metre, kilogram and second.
  void note(const std::string& unit) {
    std::string error;
    const std::optional<Unit> u = parse_unit(unit, error);
    std::string exponents;
    if (u) {
      const std::pair<const char*, int> base[] = {{"kg", u->dimension.kilogram},
                                                  {"m", u->dimension.metre},
                                                  {"s", u->dimension.second},
                                                  {"rad", unit == "rad" ? 1 : 0}};
      for (const auto& [name, power] : base)
        if (power != 0) exponents += attribute(name, std::to_string(power));
    }
    units_[unit] = exponents;
  }

  void add_input(Component& c, const InputInfo& info) {
    const std::size_t size = info.is_vector ? 3 : 1;
    std::vector<Real> start(size, std::clamp(Real{0}, info.range.low, info.range.high));
    for (const OutputInfo& o : c.info().outputs) {
      if (o.name != info.name) continue;
      const OutputValue value = o.read(c);
      if (const Vec3* v = std::get_if<Vec3>(&value)) start.assign(v->data(), v->data() + 3);
      if (const Real* x = std::get_if<Real>(&value)) start.assign(1, *x);
    }
    std::string range;
    if (std::isfinite(info.range.low)) range += attribute("min", format_real(info.range.low));
    if (std::isfinite(info.range.high)) range += attribute("max", format_real(info.range.high));
    for (std::size_t k = 0; k < size; ++k)
      add("Float64", "set." + variable_name(c, info.name) + index(size, k), "input", "continuous",
          info.unit, info.doc, attribute("start", format_real(start[k])) + range);
  }

  void add_output(const Component& c, const OutputInfo& info) {
    const OutputValue value = info.read(c);
    const bool is_text = std::holds_alternative<std::string>(value);
    const std::size_t size = std::holds_alternative<Vec3>(value) ? 3 : 1;
    for (std::size_t k = 0; k < size; ++k) {
      outputs_.push_back(count_);
      add(is_text ? "String" : "Float64", variable_name(c, info.name) + index(size, k), "output",
          is_text ? "discrete" : "continuous", is_text ? "" : info.unit, info.doc, "");
    }
  }

  static std::string index(std::size_t size, std::size_t entry) {
    return size == 1 ? std::string() : '[' + std::to_string(entry + 1) + ']';
  }

  std::string variables_;
  std::map<std::string, std::string> units_;
  std::vector<std::size_t> outputs_;
  std::size_t count_ = 0;
};

/// Tells models apart: FNV-1a of the text.
std::string token(const std::string& text) {
  std::uint64_t h = 0xcbf29ce484222325ULL;
  for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  char out[17];
  std::snprintf(out, sizeof out, "%016llx", static_cast<unsigned long long>(h));
  return std::string("{sutura-") + out + '}';
}

}  // namespace

std::string model_identifier(const std::string& name) {
  std::string out;
  for (const char c : name)
    out += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ? c : '_';
  if (out.empty() || (out.front() >= '0' && out.front() <= '9')) out.insert(0, "_");
  return out;
}

std::string model_description(const Simulation& simulation, const std::string& name) {
  const Scene& scene = simulation.scene();
  const Description d(simulation);
  const std::string dt = format_real(scene.dt);
  std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription";
  out += attribute("fmiVersion", "3.0") + attribute("modelName", name) +
         attribute("instantiationToken", token(write_scene(scene) + d.variables())) +
         attribute("generationTool", "Sutura " SUTURA_VERSION) +
         attribute("variableNamingConvention", "structured") + ">\n  <CoSimulation" +
         attribute("modelIdentifier", model_identifier(name)) +
         attribute("canGetAndSetFMUState", "true") + attribute("canSerializeFMUState", "true") +
         attribute("canHandleVariableCommunicationStepSize", "true") +
         attribute("fixedInternalStepSize", dt) + "/>\n";
  out += "  <UnitDefinitions>\n" + d.units() + "  </UnitDefinitions>\n";
  out +=
      "  <LogCategories>\n    <Category name=\"logStatusWarning\"/>\n"
      "    <Category name=\"logStatusError\"/>\n  </LogCategories>\n";
  out += "  <DefaultExperiment" + attribute("startTime", "0");
  if (scene.duration > 0) out += attribute("stopTime", format_real(scene.duration));
  out += attribute("stepSize", dt) + "/>\n";
  out += "  <ModelVariables>\n" + d.variables() + "  </ModelVariables>\n";
  out += "  <ModelStructure>\n" + d.structure() + "  </ModelStructure>\n";
  return out + "</fmiModelDescription>\n";
}

}  // namespace sutura::app
