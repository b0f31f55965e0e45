#include "csv_probe.h"

#include <sstream>

#include "sutura/diagnostics.h"
#include "sutura/units.h"

namespace sutura::output {
namespace {

std::string list_of(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& n : names) out += (out.empty() ? "" : ", ") + n;
  return out;
}

/// The names of the columns of one value, comma first.
struct HeaderOf {
  std::string name;  ///< "holder.force"
  std::string unit;  ///< " [N]" or empty
  std::string operator()(Real) const { return "," + csv_field(name + unit); }
  std::string operator()(const Vec3&) const {
    return "," + csv_field(name + ".x" + unit) + "," + csv_field(name + ".y" + unit) + "," +
           csv_field(name + ".z" + unit);
  }
  std::string operator()(const std::string&) const { return "," + csv_field(name); }
};

struct ValueOf {
  std::string operator()(Real x) const { return "," + format_real(x); }
  std::string operator()(const Vec3& v) const {
    return "," + format_real(v.x()) + "," + format_real(v.y()) + "," + format_real(v.z());
  }
  std::string operator()(const std::string& text) const { return "," + csv_field(text); }
};

}  // namespace

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + "\"";
}

void CsvProbe::describe(Describe<CsvProbe>& d) {
  d.summary(
      "Writes outputs of components to a CSV file, one row per step, with units in the header.");
  d.theory(
      "A column is the path of a component, a dot and the name of one of its outputs (each "
      "component page lists them): `/suture.tip_position /holder.force`. Vectors take three "
      "columns. Numbers are the shortest text that reads back as the same number. Each row is "
      "flushed, so a run that is cut off keeps all of its rows.");
  d.attribute("columns", &CsvProbe::columns_text_,
              "Outputs, blank separated: '/holder.force /path.friction'.")
      .required();
  d.attribute("file", &CsvProbe::file_, "Name of the file in the output folder.");
  d.attribute("report", &CsvProbe::report_,
              "Adds the columns rows, sweeps, residual and violation of the step's solve.");
  d.attribute("every", &CsvProbe::every_, at_least(1), "Write each so many steps.");
}

void CsvProbe::initialise(Setup& setup) {
  columns_.clear();
  std::istringstream names(columns_text_);
  for (std::string name; names >> name;) {
    Column column{.name = name.substr(name.front() == '/' ? 1 : 0)};
    if (const std::string error = resolve(name, *setup.scene, column); error.empty())
      columns_.push_back(column);
    else
      setup.error(*this, error);
  }
  if (const auto place = setup.output(*this, "file", file_)) path_of_file_ = *place;
}

std::string CsvProbe::resolve(const std::string& name, const Scene& scene, Column& column) const {
  const auto dot = name.rfind('.');
  if (dot == std::string::npos || dot == 0 || dot + 1 == name.size())
    return "columns: '" + name + "'; expected a component and its output, as in /holder.force";
  const std::string owner = name.substr(0, dot);
  const std::string output = name.substr(dot + 1);
  column.component = scene.find(owner);
  if (column.component == nullptr) {
    std::vector<std::string> paths;
    for (const Component* c : scene.components()) paths.push_back(c->path());
    return "columns: no component '" + owner + "' for '" + name + "'" + did_you_mean(owner, paths);
  }
  std::vector<std::string> names;
  for (const OutputInfo& o : column.component->info().outputs) {
    if (o.name == output) {
      column.output = &o;
      return {};
    }
    names.push_back(o.name);
  }
  return "columns: " + column.component->info().name + " '" + owner + "' has no output '" + output +
         "'" +
         (names.empty() ? "; it has none"
                        : did_you_mean(output, names) + "; it has " + list_of(names));
}

std::string CsvProbe::start(const Simulation&) {
  std::string header = "step,time [s]";
  for (const Column& c : columns_) {
    const std::string& unit = c.output->unit;
    const HeaderOf header_of{c.name, unit.empty() || unit == "1" ? "" : " [" + unit + "]"};
    header += std::visit(header_of, c.output->read(*c.component));
  }
  if (report_) header += ",rows,sweeps,residual,violation [m],passes,parts,imbalance,solved";
  if (std::string error = out_.open(path_of_file_); !error.empty()) return error;
  return out_.append(header + "\n");
}

std::string CsvProbe::record(const Simulation&, const StepReport& report) {
  if (report.step % every_ != 0) return {};
  row_ = std::to_string(report.step) + "," + format_real(report.time);
  for (const Column& c : columns_) row_ += std::visit(ValueOf{}, c.output->read(*c.component));
  if (report_) {
    row_ += "," + std::to_string(report.rows) + "," + std::to_string(report.solve.sweeps) + "," +
            format_real(report.solve.residual) + "," + format_real(report.violation) + "," +
            std::to_string(report.passes) + "," + std::to_string(report.parts) + "," +
            format_real(report.worst_imbalance().relative) + "," + (report.solved ? "1" : "0");
  }
  return out_.append(row_ + "\n");
}

std::string CsvProbe::finish(const Simulation&) {
  return out_.close();
}

}  // namespace sutura::output
