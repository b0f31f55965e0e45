#include "sutura/run.h"

#include <chrono>
#include <cmath>

#include "runtime/failure.h"
#include "sutura/end_note.h"

namespace sutura {
namespace {

/// Enough steps to reach the duration; 1e-6 of a step forgives the rounding of both.
Index steps_for(Real duration, Real dt) {
  constexpr Index most_steps = 1000000000;
  const Real steps = std::ceil(duration / dt - 1e-6);
  return steps < static_cast<Real>(most_steps) ? static_cast<Index>(steps) : most_steps;
}

/// 0 if nobody says how long.
Index last_step(const RunOptions& options, const Scene& scene) {
  if (options.steps) return *options.steps;
  const Real duration = options.duration.value_or(scene.duration);
  return duration > 0 ? steps_for(duration, scene.dt) : 0;
}

/// Begins to record, or goes on; an error sentence or empty.
std::string begin(Simulation& simulation, const RunOptions& options) {
  if (options.resume.empty()) return simulation.start_recording();
  const std::string error = simulation.restore(options.resume);
  return error.empty() ? simulation.resume_recording() : error;
}

/// What components say of the whole run; nothing, and why in `failure`, if one throws.
std::vector<std::string> end_notes(const Scene& scene, std::optional<Diagnostic>& failure) {
  std::vector<std::string> notes;
  for (const Component* c : scene.components()) try {
      const auto* who = dynamic_cast<const EndNote*>(c);
      const std::string note = who != nullptr ? who->end_note() : std::string();
      if (!note.empty()) notes.push_back(c->path() + ": " + note);
    } catch (...) {
      failure = failure_of(c, "when the run was done");
      return {};
    }
  return notes;
}

}  // namespace

std::filesystem::path checkpoint_file(const std::filesystem::path& output) {
  return output / "checkpoint.sutura";
}

RunResult run_scene(std::unique_ptr<Scene> scene, const RunOptions& options,
                    Diagnostics& diagnostics, const RunObserver& observer) {
  RunResult result;
  result.steps = last_step(options, *scene);
  if (result.steps == 0) {
    result.end = RunEnd::no_end;
    return result;
  }
  const auto simulation =
      Simulation::compile(std::move(scene), options.output, diagnostics, options.allow_outside);
  if (!simulation) {
    result.end = RunEnd::refused;
    return result;
  }
  const auto fail = [&result](RunEnd end, std::string message) {
    if (result.message.empty()) {
      result.end = end;
      result.message = std::move(message);
    }
  };
  const auto fail_if_broken = [&] {
    const std::optional<Diagnostic>& failure = simulation->report().failure;
    if (!failure || !result.message.empty()) return;
    diagnostics.add(*failure);
    fail(RunEnd::failed, failure->text());
  };
  const std::string unready = begin(*simulation, options);
  fail_if_broken();
  if (!unready.empty()) fail(RunEnd::file_failed, unready);
  result.first = result.last = simulation->report().step;

  const Real dt = simulation->scene().dt;
  const Index interval = options.checkpoint_every > 0 ? steps_for(options.checkpoint_every, dt) : 0;
  const auto begun = std::chrono::steady_clock::now();
  while (result.message.empty() && result.last < result.steps) {
    const StepReport& report = simulation->step();
    result.last = report.step;
    fail_if_broken();
    if (!report.finite)
      fail(RunEnd::diverged,
           "diverged: the state is no longer finite after step " + std::to_string(report.step));
    else if (!simulation->record_error().empty())
      fail(RunEnd::file_failed, simulation->record_error());
    else if (result.message.empty() && interval > 0 && report.step % interval == 0)
      if (std::string error = simulation->save(checkpoint_file(options.output)); !error.empty()) {
        fail_if_broken();
        fail(RunEnd::file_failed, std::move(error));
      }
    if (observer && !observer(*simulation, report, result)) {
      if (result.message.empty()) result.end = RunEnd::stopped;
      break;
    }
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  const std::string unfinished = simulation->finish_recording();
  fail_if_broken();
  if (!unfinished.empty()) fail(RunEnd::file_failed, unfinished);
  if (result.end == RunEnd::done) {
    std::optional<Diagnostic> failure;
    result.notes = end_notes(simulation->scene(), failure);
    if (failure) {
      diagnostics.add(*failure);
      fail(RunEnd::failed, failure->text());
    }
  }
  return result;
}

}  // namespace sutura
