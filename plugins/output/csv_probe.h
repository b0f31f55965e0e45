// CsvProbe: outputs of components over time, one row per step.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "output_file.h"
#include "sutura/describe.h"
#include "sutura/simulation.h"

namespace sutura::output {

class CsvProbe : public Component, public Recorder {
 public:
  static void describe(Describe<CsvProbe>& d);

  void initialise(Setup& setup) override;
  std::string start(const Simulation& simulation) override;
  std::string record(const Simulation& simulation, const StepReport& report) override;
  std::string finish(const Simulation& simulation) override;

 private:
  struct Column {
    std::string name = {};  ///< in the header
    const Component* component = nullptr;
    const OutputInfo* output = nullptr;
  };
  /// An error sentence, or empty.
  std::string resolve(const std::string& name, const Scene& scene, Column& column) const;

  std::string columns_text_;
  std::string file_ = "probe.csv";
  bool report_ = false;
  Index every_ = 1;

  std::filesystem::path path_of_file_;
  std::vector<Column> columns_;
  OutputFile out_;
  std::string row_;
};

/// A CSV field: quoted where it holds a comma, a quote or a line break (RFC 4180).
std::string csv_field(const std::string& text);

}  // namespace sutura::output
