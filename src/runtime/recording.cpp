// Recorders from the first file to the last.
#include "runtime/failure.h"
#include "runtime/output_folder.h"
#include "sutura/simulation.h"

namespace sutura {

/// Empty, or the sentence of the recorder, or what is said of one that throws.
template <class Call>
std::string Simulation::ask_recorder(Recorder& recorder, const Call& call) {
  try {
    return call(ask(&recorder));
  } catch (...) {
    const Diagnostic failure = failure_of(asked_, "while it recorded");
    if (!report_.failure) report_.failure = failure;
    return failure.node_path + ": " + failure.message;
  }
}

/// In a step: what a recorder throws is a failure of the step.
void Simulation::record() {
  for (Recorder* recorder : recorders_)
    if (recording_ && record_error_.empty()) record_error_ = ask(recorder).record(*this, report_);
}

std::string Simulation::take_folder(bool files_stay) {
  if (written_files_.empty()) return {};
  output_ = std::make_unique<OutputFolder>();
  return output_->take(output_directory_, written_files_,
                       files_stay ? OutputFolder::Before::stays : OutputFolder::Before::goes);
}

std::string Simulation::start_recording() {
  record_error_ = take_folder(false);
  recording_ = record_error_.empty();
  for (Recorder* recorder : recorders_) {
    if (!record_error_.empty()) break;
    record_error_ = ask_recorder(*recorder, [this](Recorder& r) {
      const std::string error = r.start(*this);
      return error.empty() ? r.record(*this, report_) : error;
    });
  }
  return record_error_;
}

std::string Simulation::resume_recording() {
  record_error_ = take_folder(true);
  recording_ = record_error_.empty();
  for (Recorder* recorder : recorders_) {
    if (!record_error_.empty()) break;
    record_error_ = ask_recorder(*recorder, [this](Recorder& r) { return r.resume(*this); });
  }
  return record_error_;
}

std::string Simulation::finish_recording() {
  recording_ = false;
  for (Recorder* recorder : recorders_) {
    const std::string error =
        ask_recorder(*recorder, [this](Recorder& r) { return r.finish(*this); });
    if (record_error_.empty()) record_error_ = error;
  }
  output_.reset();
  return record_error_;
}

}  // namespace sutura
