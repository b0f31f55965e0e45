#include "constraint_table.h"

#include "csv_probe.h"
#include "sutura/archive.h"
#include "sutura/units.h"

namespace sutura::output {

void ConstraintTable::describe(Describe<ConstraintTable>& d) {
  d.summary(
      "Writes every constraint of every step to a CSV file: whose it is, its law and state, where "
      "it acts, its force, "
      "and how far it is from its law.");
  d.theory(
      "One row per block. `source` is the path of the component that made it and `id` the number "
      "by which that component "
      "knows it in the next step (a sample of a path keeps its own). `state` is the mode of the "
      "block, a small number that the "
      "law's header explains. The force acts on the first body of the block, in world axes. "
      "`violation [m]` is how far the "
      "block would move if its law were asked once more: |D (lambda_plus - lambda)|, D the "
      "diagonal of its W, the natural map of one block.");
  d.attribute("file", &ConstraintTable::file_, "Name of the file in the output folder.");
  d.attribute("every", &ConstraintTable::every_, at_least(1), "Write each so many steps.");
}

void ConstraintTable::initialise(Setup& setup) {
  if (const auto place = setup.output(*this, "file", file_)) path_of_file_ = *place;
}

void ConstraintTable::archive(Archive& a) {
  a("end", end_);
}

void ConstraintTable::find_sources(const Simulation& simulation) {
  sources_.clear();
  for (const Component* c : simulation.scene().components())
    sources_.push_back(csv_field(c->path()));
}

std::string ConstraintTable::append(std::string_view text) {
  std::string error = out_.append(text);
  end_ = out_.end();
  return error;
}

std::string ConstraintTable::resume(const Simulation& simulation) {
  if (end_ == 0) return start(simulation);
  find_sources(simulation);
  return out_.resume(path_of_file_, end_);
}

std::string ConstraintTable::start(const Simulation& simulation) {
  find_sources(simulation);
  if (std::string error = out_.open(path_of_file_); !error.empty()) return error;
  return append(
      "step,time [s],source,id,law,state,at.x [m],at.y [m],at.z [m],force.x [N],force.y "
      "[N],force.z [N],violation [m]\n");
}

std::string ConstraintTable::record(const Simulation& simulation, const StepReport& report) {
  if (report.step == 0 || report.step % every_ != 0) return {};
  const ConstraintProblem& problem = simulation.problem();
  const std::string when = std::to_string(report.step) + "," + format_real(report.time) + ",";
  rows_.clear();
  for (const ConstraintBlock& b : problem.blocks) {
    const auto source = static_cast<std::size_t>(source_of(b.key)) - 1;
    const Vec3 force = problem.block_force(b);
    rows_ += when + (source < sources_.size() ? sources_[source] : "") + "," +
             std::to_string(local_of(b.key)) + "," + b.law->name + "," + std::to_string(b.mode);
    for (const Real value :
         {b.at.x(), b.at.y(), b.at.z(), force.x(), force.y(), force.z(), b.violation})
      rows_ += "," + format_real(value);
    rows_ += "\n";
  }
  return append(rows_);
}

}  // namespace sutura::output
