// ConstraintTable: every constraint of every step as a row of a CSV file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "output_file.h"
#include "sutura/describe.h"
#include "sutura/simulation.h"

namespace sutura::output {

class ConstraintTable : public Component, public Recorder {
 public:
  static void describe(Describe<ConstraintTable>& d);

  void initialise(Setup& setup) override;
  void archive(Archive& archive) override;
  std::string start(const Simulation& simulation) override;
  std::string record(const Simulation& simulation, const StepReport& report) override;
  std::string resume(const Simulation& simulation) override;
  std::string finish(const Simulation&) override { return out_.close(); }

 private:
  void find_sources(const Simulation& simulation);
  std::string append(std::string_view text);

  std::string file_ = "constraints.csv";
  Index every_ = 1;

  std::filesystem::path path_of_file_;
  OutputFile out_;
  std::int64_t end_ = 0;              ///< bytes of the file so far
  std::vector<std::string> sources_;  ///< paths of the components, as CSV fields, in document order
  std::string rows_;
};

}  // namespace sutura::output
