#include "csv_probe.h"

#include <sstream>

#include "sutura/archive.h"
#include "sutura/units.h"

namespace sutura::output {
namespace {

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
      "columns, x, y and z. Numbers are the shortest text that reads back as the same number. Each "
      "row is "
      "flushed, so a run that is cut off keeps all of its rows.");
  d.attribute("columns", &CsvProbe::columns_text_,
              "Outputs, blank separated: '/holder.force /path.friction'. The header names them "
              "without the first slash: 'holder.force.x [N]'.")
      .required();
  d.attribute("file", &CsvProbe::file_, "Name of the file in the output folder.");
  d.attribute("report", &CsvProbe::report_,
              "Adds the columns rows, sweeps, residual, violation, passes, parts, imbalance, "
              "time_error and solved of the step.");
  d.attribute("every", &CsvProbe::every_, at_least(1), "Write each so many steps.");
}

void CsvProbe::initialise(Setup& setup) {
  columns_.clear();
  std::istringstream names(columns_text_);
  for (std::string name; names >> name;) {
    std::string error;
    if (const OutputHandle output = setup.scene->output(name, error))
      columns_.push_back({name.substr(name.front() == '/' ? 1 : 0), output});
    else
      setup.error(*this, "columns: " + error);
  }
  if (const auto place = setup.output(*this, "file", file_)) path_of_file_ = *place;
}

void CsvProbe::archive(Archive& a) {
  a("end", end_);
}

std::string CsvProbe::start(const Simulation&) {
  std::string header = "step,time [s]";
  for (const Column& c : columns_) {
    const std::string& unit = c.output.info->unit;
    const HeaderOf header_of{c.name, unit.empty() || unit == "1" ? "" : " [" + unit + "]"};
    header += std::visit(header_of, c.output.read());
  }
  if (report_)
    header += ",rows,sweeps,residual,violation [m],passes,parts,imbalance,time_error [m],solved";
  if (std::string error = out_.open(path_of_file_); !error.empty()) return error;
  return append(header + "\n");
}

std::string CsvProbe::resume(const Simulation& simulation) {
  return end_ == 0 ? start(simulation) : out_.resume(path_of_file_, end_);
}

std::string CsvProbe::append(std::string_view text) {
  std::string error = out_.append(text);
  end_ = out_.end();
  return error;
}

std::string CsvProbe::record(const Simulation&, const StepReport& report) {
  if (report.step % every_ != 0) return {};
  row_ = std::to_string(report.step) + "," + format_real(report.time);
  for (const Column& c : columns_) row_ += std::visit(ValueOf{}, c.output.read());
  if (report_) {
    row_ += "," + std::to_string(report.rows) + "," + std::to_string(report.solve.sweeps) + "," +
            format_real(report.solve.residual) + "," + format_real(report.violation) + "," +
            std::to_string(report.passes) + "," + std::to_string(report.parts) + "," +
            format_real(report.worst_imbalance().relative) + "," +
            format_real(report.worst_time_error()) + "," + (report.solved ? "1" : "0");
  }
  row_ += '\n';
  return append(row_);
}

std::string CsvProbe::finish(const Simulation&) {
  return out_.close();
}

}  // namespace sutura::output
