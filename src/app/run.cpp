#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
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
  explicit Progress(Index steps) : steps_(steps), shown_(isatty(STDERR_FILENO) == 1) {}
  ~Progress() { clear(); }

  void show(const StepReport& report) {
    constexpr double interval = 0.1;  // s, wall
    if (!shown_ || seconds_since(last_) < interval) return;
    last_ = std::chrono::steady_clock::now();
    std::fprintf(stderr, "\rstep %ld of %ld, t = %.3f s, %ld rows, %.1f ms/step   ",
                 static_cast<long>(report.step), static_cast<long>(steps_), report.time,
                 static_cast<long>(report.rows), 1e3 * report.total_seconds());
    written_ = true;
  }
  void clear() {
    if (written_) std::fprintf(stderr, "\r\033[K");
    written_ = false;
  }

 private:
  Index steps_;
  bool shown_;
  bool written_ = false;
  std::chrono::steady_clock::time_point last_{};
};

constexpr Index most_steps = 1000000000;

/// Enough steps to reach the duration; 1e-6 of a step forgives the rounding of both.
Index steps_for(Real duration, Real dt) {
  const Real steps = std::ceil(duration / dt - 1e-6);
  return steps < static_cast<Real>(most_steps) ? static_cast<Index>(steps) : most_steps;
}

/// 0, after a complaint, if nobody says how long.
Index number_of_steps(const RunArguments& arguments, const Scene& scene) {
  if (arguments.steps) return *arguments.steps;
  Real duration = scene.duration;
  if (!arguments.duration.empty()) {
    std::string why;
    const std::optional<Real> given = parse_quantity(arguments.duration, "s", why);
    if (!given || *given <= 0) {
      complain("--duration: " + (given ? "'" + arguments.duration + "' is not above 0 s" : why));
      return 0;
    }
    duration = *given;
  } else if (duration <= 0) {
    complain("how long? Give --steps or --duration, or <sutura duration=\"4 s\"> in the scene");
    return 0;
  }
  return steps_for(duration, scene.dt);
}

}  // namespace

int run(const RunArguments& arguments) {
  LoadOptions options;
  if (!load_options(arguments.scene, options)) return usage;
  Registry registry;
  enrol_builtin(registry);
  Diagnostics diagnostics;
  std::unique_ptr<Scene> scene = load_scene(arguments.scene.scene, registry, diagnostics, options);
  if (!scene) return report(diagnostics);
  const Index steps = number_of_steps(arguments, *scene);
  if (steps == 0) return usage;

  const std::string output =
      arguments.output.empty()
          ? "out/" + std::filesystem::path(arguments.scene.scene).stem().string()
          : arguments.output;
  const auto simulation =
      Simulation::compile(std::move(scene), output, diagnostics, arguments.scene.allow_outside);
  const int load_code = report(diagnostics);
  if (!simulation) return load_code;

  catch_interrupts();
  std::string file_error = simulation->start_recording();
  Summary summary;
  bool finite = true;
  const auto begin = std::chrono::steady_clock::now();
  {
    Progress progress(steps);
    for (Index i = 0; i < steps && finite && file_error.empty() && !stop_requested; ++i) {
      const StepReport& step = simulation->step();
      summary.add(step);
      finite = step.finite;
      file_error = simulation->record_error();
      progress.show(step);
    }
  }
  const double wall = seconds_since(begin);
  const std::string finish_error = simulation->finish_recording();
  if (file_error.empty()) file_error = finish_error;

  std::printf("%s: %s", arguments.scene.scene.c_str(), summary.text(wall).c_str());
  std::fflush(stdout);
  if (!file_error.empty()) complain(file_error);
  if (!finite)
    complain("diverged: the state is no longer finite after step " +
             std::to_string(simulation->report().step));
  if (!finite) return diverged;
  if (!file_error.empty()) return static_cast<int>(Category::file);
  if (stop_requested) return interrupted;
  if (summary.missed() > 0 && !arguments.lenient)
    complain(std::to_string(summary.missed()) +
             " steps are less accurate than asked, or faulty: see the summary (--lenient accepts that)");
  return summary.missed() > 0 && !arguments.lenient ? inaccurate : ok;
}

}  // namespace sutura::app
