// What contact costs: detection against the number of beams, touches that lie all along a thread,
// and a thread that lands on tissue. Times are of one core, by the stages of the step.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "sutura/describe.h"
#include "sutura/simulation.h"

namespace sutura {
namespace {

double of_stage(const StepReport& report, Stage stage) {
  return report.seconds[static_cast<std::size_t>(stage)];
}

/// Runs a scene given as text; `each` is called after every step until it returns false.
bool run(const std::string& settings, const std::string& content,
         const std::function<bool(const StepReport&)>& each) {
  Registry registry;
  enrol_builtin(registry);
  Diagnostics diagnostics;
  const std::string text = "<sutura version='1' " + settings +
                           "><plugin name='thread'/><plugin name='tissue'/>"
                           "<plugin name='contact'/>" +
                           content + "</sutura>";
  auto scene = load_scene_text(text, "bench", ".", registry, diagnostics);
  const auto simulation = scene ? Simulation::compile(std::move(scene), ".", diagnostics) : nullptr;
  for (const Diagnostic& d : diagnostics.all()) std::fprintf(stderr, "%s\n", d.text().c_str());
  if (!simulation) return false;
  while (each(simulation->step())) {
  }
  return true;
}

/// A helix of `beams` at rest whose turns are `gap` thread diameters apart, centre to centre.
std::string helix(int beams, double gap, const std::string& contact) {
  const double diameter = 0.2e-3, radius = 3e-3;  // m
  const double rise = gap * diameter / (2 * std::numbers::pi),
               square = radius * radius + rise * rise;
  const auto number = [](double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", x);
    return std::string(text);
  };
  return "<SutureThread name='a' needle_length='0' thread='4-0 polypropylene' thread_diameter='" +
         number(diameter) + "' thread_length='" + number(0.4e-3 * beams) + "' thread_beams='" +
         std::to_string(beams) + "' thread_rest_curvature='" + number(radius / square) +
         "' thread_rest_torsion='" + number(rise / square) + "' clamp='both'/>" + contact;
}

struct Cost {
  double detection = 1e30, step = 1e30;  // s, the least of some steps
  Index rows = 0, passes = 0;
};

/// The least over `steps` steps, after one that reserves memory.
bool cost(const std::string& content, int steps, Cost& out) {
  int count = 0;
  return run("dt='5 ms' gravity='0 0 0'", content, [&](const StepReport& report) {
    if (count++ == 0) return true;
    out.detection = std::min(out.detection, of_stage(report, Stage::detect));
    out.step = std::min(out.step, report.total_seconds());
    out.rows = report.rows;
    out.passes = report.passes;
    return count <= steps;
  });
}

bool detection(const std::filesystem::path& folder) {
  std::ofstream csv(folder / "contact_detection.csv");
  csv << "case,beams,detection [ms],rows\n";
  std::printf("%-40s %8s %14s %6s\n", "helix", "beams", "detection", "rows");
  const auto one = [&](const std::string& name, int beams, const std::string& content) {
    Cost found;
    if (!cost(content, 12, found)) return false;
    std::printf("%-40s %8d %11.3f ms %6td\n", name.c_str(), beams, 1e3 * found.detection,
                found.rows);
    csv << name << ',' << beams << ',' << 1e3 * found.detection << ',' << found.rows << '\n';
    return true;
  };
  for (const int beams : {500, 1000, 2000, 4000, 8000})
    if (!one("turns three diameters apart", beams, helix(beams, 3, "<Contact first='a'/>")))
      return false;
  return one("no contact in the scene", 1000, helix(1000, 3, ""));
}

/// A thread of 150 beams that falls flat on a block of 945 nodes, and lies there.
bool landing(const std::filesystem::path& folder) {
  const std::string scene =
      "<node name='skin'><BlockMesh box='-21 -12 -9  21 12 0 mm' cells='14 8 6'/>"
      "<Tissue name='tissue' young='20 kPa' poisson='0.45' density='1000' element='t4' "
      "damping_stiffness='10 ms'/><Attach box='-21 -12 -9  21 12 -9 mm'/></node>"
      "<SutureThread name='a' needle_length='0' thread='4-0 polypropylene' thread_length='40 mm' "
      "thread_beams='150' tip='-20 0.3 0.2 mm' tip_direction='-1 0 0' damping_stiffness='0.1 ms'/>"
      "<Contact first='a' second='/skin/tissue' friction='0.3'/>";
  std::ofstream csv(folder / "contact_landing.csv");
  csv << "time [s],step [ms],compliance [ms],solve [ms],detection [ms],rows,passes,parts,sweeps,"
         "direct solves,solved\n";
  std::printf("\n%-8s %10s %10s %10s %10s %5s %6s %6s %6s\n", "time", "step ms", "W ms", "solve ms",
              "detect ms", "rows", "passes", "sweeps", "direct");
  std::vector<double> all;
  const bool ran = run("dt='10 ms' gravity='0 0 -9.81'", scene, [&](const StepReport& r) {
    const double ms = 1e3 * r.total_seconds(), W = 1e3 * of_stage(r, Stage::compliance),
                 solve = 1e3 * of_stage(r, Stage::solve), detect = 1e3 * of_stage(r, Stage::detect);
    all.push_back(ms);
    csv << r.time << ',' << ms << ',' << W << ',' << solve << ',' << detect << ',' << r.rows << ','
        << r.passes << ',' << r.parts << ',' << r.solve.sweeps << ',' << r.solve.direct_solves
        << ',' << r.solved << '\n';
    if (all.size() <= 12 || all.size() % 20 == 0)
      std::printf("%-8.3g %10.2f %10.2f %10.2f %10.2f %5td %6td %6td %6td\n", r.time, ms, W, solve,
                  detect, r.rows, r.passes, r.solve.sweeps, r.solve.direct_solves);
    return r.time < 1 - 1e-9;
  });
  if (!ran) return false;
  std::vector<double> sorted = all;
  std::sort(sorted.begin(), sorted.end());
  std::printf("a thread lands on tissue: median %.1f ms a step, largest %.1f ms, %.1f ms in all\n",
              sorted[sorted.size() / 2], sorted.back(), [&] {
                double sum = 0;
                for (const double ms : all) sum += ms;
                return sum;
              }());
  return true;
}

}  // namespace
}  // namespace sutura

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: sutura_bench_contact FOLDER\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  return sutura::detection(folder) && sutura::landing(folder) ? 0 : 1;
}
