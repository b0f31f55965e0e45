#include "csv_probe.h"

#include <sstream>

#include "sutura/diagnostics.h"
#include "sutura/units.h"

namespace sutura::output {
namespace {

std::string did_you_mean(const std::string& name, const std::vector<std::string>& candidates) {
  const std::string nearest = nearest_name(name, candidates);
  return nearest.empty() ? std::string() : "; did you mean '" + nearest + "'?";
}

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
  directory_ = setup.output_directory;
  if (file_.empty()) setup.error(*this, "'file' is empty; expected a name such as probe.csv");
}

std::string CsvProbe::resolve(const std::string& name, const Simulation& simulation,
                              Column& column) const {
  const auto dot = name.rfind('.');
  if (dot == std::string::npos || dot == 0 || dot + 1 == name.size()) {
    return path() + ": column '" + name +
           "'; expected a component and its output, as in /holder.force";
  }
  const std::string owner = name.substr(0, dot);
  const std::string output = name.substr(dot + 1);
  column.component = simulation.scene().find(owner);
  if (column.component == nullptr) {
    std::vector<std::string> paths;
    for (const Component* c : simulation.scene().components()) paths.push_back(c->path());
    return path() + ": no component '" + owner + "' for column '" + name + "'" +
           did_you_mean(owner, paths);
  }
  std::vector<std::string> names;
  for (const OutputInfo& o : column.component->info().outputs) {
    if (o.name == output) {
      column.output = &o;
      return {};
    }
    names.push_back(o.name);
  }
  return path() + ": " + column.component->info().name + " '" + owner + "' has no output '" +
         output + "'" +
         (names.empty() ? "; it has none"
                        : did_you_mean(output, names) + "; it has " + list_of(names));
}

std::string CsvProbe::start(const Simulation& simulation) {
  columns_.clear();
  std::istringstream names(columns_text_);
  std::string header = "step,time [s]";
  for (std::string name; names >> name;) {
    Column column;
    if (std::string error = resolve(name, simulation, column); !error.empty()) return error;
    columns_.push_back(column);
    const std::string unit = column.output->unit.empty() || column.output->unit == "1"
                                 ? std::string()
                                 : " [" + column.output->unit + "]";
    header += std::visit(HeaderOf{name.substr(name.front() == '/' ? 1 : 0), unit},
                         column.output->read(*column.component));
  }
  if (report_) header += ",rows,sweeps,residual,violation [m],passes,parts,imbalance,solved";
  for (const Component* other : simulation.scene().components()) {
    if (other == this) break;
    const auto* probe = dynamic_cast<const CsvProbe*>(other);
    if (probe != nullptr && probe->file_ == file_) {
      return path() + " would overwrite '" + file_ + "' of " + other->path() +
             "; expected another 'file'";
    }
  }
  if (std::string error = out_.open(directory_ / file_); !error.empty()) return error;
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
