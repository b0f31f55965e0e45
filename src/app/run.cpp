#include "sutura/run.h"

#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>

#include "app/commands.h"
#include "app/summary.h"
#include "sutura/units.h"

namespace sutura::app {

namespace {

volatile sig_atomic_t stop_requested = 0;
void request_stop(int) {
  stop_requested = 1;
}

/// The first Ctrl-C ends the run after the current step; the second one ends the program.
void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = request_stop;
  action.sa_flags = SA_RESETHAND;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// A line that rewrites itself, on a terminal only.
class Progress {
 public:
  Progress() : shown_(isatty(STDERR_FILENO) == 1) {}
  ~Progress() {
    if (written_) std::fprintf(stderr, "\r\033[K");
  }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(const StepReport& report, Index steps) {
    constexpr double interval = 0.1;  // s, wall
    if (!shown_ || seconds_since(last_) < interval) return;
    last_ = std::chrono::steady_clock::now();
    std::fprintf(stderr, "\rstep %ld of %ld, t = %.3f s, %ld rows, %.1f ms/step   ",
                 static_cast<long>(report.step), static_cast<long>(steps), report.time,
                 static_cast<long>(report.rows), 1e3 * report.total_seconds());
    written_ = true;
  }

 private:
  bool shown_;
  bool written_ = false;
  std::chrono::steady_clock::time_point last_{};
};

/// A time from the command line that must be above zero; nothing, after a complaint, if it is not.
std::optional<Real> time_of(const char* option, const std::string& text) {
  std::string why;
  const std::optional<Real> time = parse_quantity(text, "s", why);
  if (time && *time > 0) return time;
  complain(std::string(option) + ": " + (time ? "'" + text + "' is not above 0 s" : why));
  return {};
}

/// False, after a complaint, if a time is wrong.
bool run_options(const RunArguments& arguments, RunOptions& options) {
  options.output = arguments.output.empty()
                       ? "out/" + std::filesystem::path(arguments.scene.scene).stem().string()
                       : arguments.output;
  options.steps = arguments.steps;
  options.resume = arguments.resume;
  options.allow_outside = arguments.scene.allow_outside;
  if (!arguments.duration.empty()) {
    options.duration = time_of("--duration", arguments.duration);
    if (!options.duration) return false;
  }
  if (!arguments.checkpoint_every.empty()) {
    const std::optional<Real> every = time_of("--checkpoint-every", arguments.checkpoint_every);
    if (!every) return false;
    options.checkpoint_every = *every;
  }
  return true;
}

int exit_code(const RunResult& result, const Diagnostics& diagnostics) {
  switch (result.end) {
    case RunEnd::done:
      return ok;
    case RunEnd::stopped:
      return interrupted;
    case RunEnd::diverged:
      return diverged;
    case RunEnd::file_failed:
      return static_cast<int>(Category::file);
    case RunEnd::no_end:
      return usage;
    case RunEnd::failed:
    case RunEnd::refused:
      break;
  }
  return diagnostics.exit_code();
}

}  // namespace

int run(const RunArguments& arguments) {
  LoadOptions load;
  RunOptions options;
  if (!load_options(arguments.scene, load) || !run_options(arguments, options)) return usage;
  Registry registry;
  enrol_builtin(registry);
  Diagnostics diagnostics;
  std::unique_ptr<Scene> scene = load_scene(arguments.scene.scene, registry, diagnostics, load);
  if (!scene) return report(diagnostics);

  catch_interrupts();
  Summary summary;
  RunResult result;
  {
    Progress progress;
    result = run_scene(std::move(scene), options, diagnostics,
                       [&](Simulation&, const StepReport& step, const RunResult& so_far) {
                         summary.add(step);
                         progress.show(step, so_far.steps);
                         return !stop_requested;
                       });
  }
  report(diagnostics);
  if (result.end == RunEnd::no_end)
    complain("how long? Give --steps or --duration, or <sutura duration=\"4 s\"> in the scene");
  if (result.end != RunEnd::no_end && result.end != RunEnd::refused) {
    std::printf("%s: %s", arguments.scene.scene.c_str(), summary.text(result.seconds).c_str());
    for (const std::string& note : result.notes) std::printf("  note: %s\n", note.c_str());
    std::fflush(stdout);
  }
  if (!result.message.empty() && result.end != RunEnd::failed) complain(result.message);
  if (result.end == RunEnd::done && summary.missed() > 0 && !arguments.lenient) {
    complain(std::to_string(summary.missed()) +
             " steps are less accurate than asked, or faulty: see the summary (--lenient accepts "
             "that)");
    return inaccurate;
  }
  return exit_code(result, diagnostics);
}

}  // namespace sutura::app
