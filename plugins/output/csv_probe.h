// CsvProbe: outputs of components over time, one row per step.
#pragma once

#include <cstdint>
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
  void archive(Archive& archive) override;
  std::string start(const Simulation& simulation) override;
  std::string record(const Simulation& simulation, const StepReport& report) override;
  std::string resume(const Simulation& simulation) override;
  std::string finish(const Simulation& simulation) override;

 private:
  struct Column {
    std::string name;  ///< in the header
    OutputHandle output;
  };
  std::string append(std::string_view text);

  std::string columns_text_;
  std::string file_ = "probe.csv";
  bool report_ = false;
  Index every_ = 1;

  std::filesystem::path path_of_file_;
  std::vector<Column> columns_;
  OutputFile out_;
  std::int64_t end_ = 0;  ///< bytes of the file so far
  std::string row_;
};

/// A CSV field: quoted where it holds a comma, a quote or a line break (RFC 4180).
std::string csv_field(const std::string& text);

}  // namespace sutura::output
