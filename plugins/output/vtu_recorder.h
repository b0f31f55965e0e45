// VtuRecorder: bodies and constraint forces over time, for ParaView.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "constraint_grid.h"
#include "sutura/describe.h"
#include "sutura/simulation.h"
#include "vtu.h"

namespace sutura::output {

class VtuRecorder : public Component, public Recorder {
 public:
  static void describe(Describe<VtuRecorder>& d);

  void initialise(Setup& setup) override;
  void archive(Archive& archive) override;
  std::string start(const Simulation& simulation) override;
  std::string record(const Simulation& simulation, const StepReport& report) override;
  std::string resume(const Simulation& simulation) override;
  std::string finish(const Simulation& simulation) override;

 private:
  /// One .pvd and the folder of its .vtu files.
  struct Series {
    std::string name;
    PvdFile pvd;
    VtuCells cells;
  };
  bool due(const StepReport& report);
  std::string write(Series& series, const VtuGrid& grid, const StepReport& report);

  Index every_ = 1;
  Real interval_ = 0;

  std::filesystem::path directory_;
  std::vector<Series> series_;  ///< as Simulation::bodies, then the constraints, then drawings_
  std::vector<const Drawing*> drawings_;
  std::vector<std::int64_t> ends_;  ///< bytes of their .pvd so far
  LawNumbers laws_;
  Real next_time_ = 0;
};

/// "/skin/tissue" -> "skin_tissue"; never one that is in `taken`.
std::string file_name_of(const std::string& path, const std::vector<std::string>& taken);

}  // namespace sutura::output
