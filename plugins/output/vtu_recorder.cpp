#include "vtu_recorder.h"

#include <algorithm>
#include <cmath>

#include "sutura/archive.h"

namespace sutura::output {
namespace {

VtuGrid grid_of(BodyGeometry geometry) {
  VtuGrid grid;
  grid.cell = geometry.cell == BodyGeometry::Cell::line ? VtkCell::line : VtkCell::tetrahedron;
  grid.points = std::move(geometry.points);
  grid.connectivity = std::move(geometry.connectivity);
  grid.fields = std::move(geometry.fields);
  return grid;
}

std::string step_digits(Index step) {
  std::string digits = std::to_string(step);
  return digits.size() < 6 ? std::string(6 - digits.size(), '0') + digits : digits;
}

}  // namespace

std::string file_name_of(const std::string& path, const std::vector<std::string>& taken) {
  std::string name = path.substr(std::min(path.find_first_not_of('/'), path.size()));
  std::replace(name.begin(), name.end(), '/', '_');
  std::string unique = name;
  for (int i = 2; std::find(taken.begin(), taken.end(), unique) != taken.end(); ++i) {
    unique = name + "_" + std::to_string(i);
  }
  return unique;
}

void VtuRecorder::describe(Describe<VtuRecorder>& d) {
  d.summary(
      "Writes the shape and the fields of every body, and the constraint forces, as .vtu files "
      "with a .pvd index each, for ParaView, VTK or meshio.");
  d.theory(
      "In the output folder: `BODY.pvd` and `BODY/BODY_000012.vtu` for each body (the number is "
      "the step), `constraints.pvd` and `constraints/...` for the forces: one vertex per block "
      "with `force [N]` on the first body of the block, the norms `lambda [N]` and `delta [m]` "
      "over its rows, `violation [m]` (how far it is from its law), `mode` and `law`. Field data "
      "named like `law 0 is puncture` tell the "
      "numbers of laws; they hold for the whole run. A step without constraints has one vertex "
      "with law -1 and no force, because some readers refuse an empty grid. A .pvd is complete "
      "after every record, so a run that is cut off can be looked at. A component that draws "
      "itself "
      "(`Drawing` in `include/sutura/body.h`) is written like a body, but for the steps in which "
      "it "
      "has nothing to draw. The point field `drawn radius [m]` of a thread, with ParaView's Tube "
      "and "
      "*Vary Radius: By Absolute Scalar*, draws it as thick as it is, and the needle with a "
      "point.");
  d.attribute("every", &VtuRecorder::every_, at_least(1), "Record each so many steps.");
  d.attribute("interval", &VtuRecorder::interval_, "s", between(0, 1e12),
              "Time between records; 0: by steps, as 'every' says.");
}

void VtuRecorder::initialise(Setup& setup) {
  directory_ = setup.output_directory;
  series_.clear();
  drawings_.clear();
  std::vector<std::string> taken{"constraints"};
  const auto add = [&](const Component& c) {
    taken.push_back(file_name_of(c.path(), taken));
    series_.push_back({taken.back(), {}, {}});
  };
  for (const Component* c : setup.scene->components())
    if (dynamic_cast<const Body*>(c) != nullptr) add(*c);
  series_.push_back({"constraints", {}, {}});
  for (const Component* c : setup.scene->components())
    if (const auto* drawing = dynamic_cast<const Drawing*>(c)) {
      add(*c);
      drawings_.push_back(drawing);
    }
  for (const Series& s : series_) {
    // One complaint is enough where two recorders write the same.
    if (!setup.output(*this, "files", s.name + ".pvd") ||
        !setup.output(*this, "files", s.name, "*.vtu"))
      return;
  }
}

std::string VtuRecorder::start(const Simulation&) {
  laws_ = {};
  next_time_ = 0;
  ends_.assign(series_.size(), 0);
  for (std::size_t i = 0; i < series_.size(); ++i) {
    Series& s = series_[i];
    if (std::string e = s.pvd.open(directory_ / (s.name + ".pvd")); !e.empty()) return e;
    ends_[i] = s.pvd.end();
  }
  return {};
}

void VtuRecorder::archive(Archive& a) {
  a("ends", ends_);
  a("next_time", next_time_);
  laws_.archive(a);
}

std::string VtuRecorder::resume(const Simulation& simulation) {
  if (ends_.empty()) return start(simulation);
  if (ends_.size() != series_.size()) return path() + ": the state names other files";
  for (std::size_t i = 0; i < series_.size(); ++i) {
    Series& s = series_[i];
    if (std::string e = s.pvd.resume(directory_ / (s.name + ".pvd"), ends_[i]); !e.empty())
      return e;
  }
  return {};
}

bool VtuRecorder::due(const StepReport& report) {
  if (interval_ <= 0) return report.step % every_ == 0;
  // A millionth of the interval forgives the rounding of times that are sums of steps.
  if (report.time < next_time_ - 1e-6 * interval_) return false;
  next_time_ = (std::floor(report.time / interval_ + 1e-6) + 1) * interval_;
  return true;
}

std::string VtuRecorder::record(const Simulation& simulation, const StepReport& report) {
  if (!due(report)) return {};
  const std::size_t bodies = simulation.bodies().size();
  for (std::size_t i = 0; i < series_.size(); ++i) {
    const VtuGrid grid = i < bodies    ? grid_of(simulation.bodies()[i].body->geometry())
                         : i == bodies ? constraint_grid(simulation.problem(), laws_)
                                       : grid_of(drawings_[i - bodies - 1]->geometry());
    if (grid.points.empty()) continue;
    if (std::string e = write(series_[i], grid, report); !e.empty()) return e;
    ends_[i] = series_[i].pvd.end();
  }
  return {};
}

std::string VtuRecorder::write(Series& series, const VtuGrid& grid, const StepReport& report) {
  if (const std::string wrong = check(grid); !wrong.empty()) return series.name + ": " + wrong;
  const std::filesystem::path file =
      std::filesystem::path(series.name) / (series.name + "_" + step_digits(report.step) + ".vtu");
  std::string error = write_file(directory_ / file, vtu_text(grid, report.time, series.cells));
  return error.empty() ? series.pvd.add(report.time, file) : error;
}

std::string VtuRecorder::finish(const Simulation&) {
  std::string error;
  for (Series& s : series_) {
    if (std::string e = s.pvd.close(); error.empty()) error = std::move(e);
  }
  return error;
}

}  // namespace sutura::output
