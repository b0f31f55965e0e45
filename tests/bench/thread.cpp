// What the thread costs and what it buys:
//   thread_work_precision.csv   error against CPU time per step, 4 to 256 beams: card "suture
//   cantilever"
//                               (heavy cantilever at rest) and elastica end loads
//   thread_cost.csv             ns per beam of each part of the implicit step, 200 to 10 000 beams
//   thread_sampling.csv         a tight loop, adaptive against uniform beams: errors, beams, CPU
//   time per step thread_start.csv            the card from the horizontal, step by step size:
//   error at rest, passes
// Usage: sutura_bench_thread OUTPUT_FOLDER. Times are CPU time of this thread, best of several
// rounds.
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "unit/thread/divided_step.h"
#include "unit/thread/rod_builder.h"
#include "validation/thread/loop.h"

namespace sutura::thread {
namespace {

double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Best time of one call, over rounds that each last at least 2 ms.
template <class F>
double best_time(F f, int rounds = 7) {
  int repeat = 1;
  double best = 1e9;
  for (int r = 0; r < rounds;) {
    const double t0 = cpu_seconds();
    for (int i = 0; i < repeat; ++i) f();
    const double t = cpu_seconds() - t0;
    if (t < 2e-3) {
      repeat *= 2;
      continue;
    }
    best = std::min(best, t / repeat);
    ++r;
  }
  return best;
}

const Vec3 gravity(0, 0, -9.81);

/// The card of the comparison: L 0.2 m, r 0.15 mm, E 1 GPa, rho 1300, nu 0.3, clamped horizontally.
Section card() {
  return {.radius = 0.15e-3, .young = 1e9, .poisson = 0.3, .density = 1300};
}

double step_time(Rod& rod, RodStep& step, Real dt, const Vec3& g, const VecX& force) {
  return best_time([&] {
    if (step.advance(rod, dt, g, force, well_balanced) == 0) std::abort();
  });
}

void work_precision(std::FILE* csv) {
  std::fprintf(csv, "case,beams,error_m,error_over_L,cpu_us_per_step\n");
  std::printf("%-22s %6s %12s %12s %14s\n", "case", "beams", "error", "error/L", "us per step");
  const auto row = [&](const char* name, Index n, Real error, Real length, double seconds) {
    std::fprintf(csv, "%s,%ld,%.6e,%.6e,%.4f\n", name, static_cast<long>(n), error, error / length,
                 1e6 * seconds);
    std::printf("%-22s %6ld %9.3g mm %12.3e %14.2f\n", name, static_cast<long>(n), 1e3 * error,
                error / length, 1e6 * seconds);
  };
  for (Index n = 4; n <= 256; n *= 2) {
    Rod rod;
    rod.build(straight_layout(0.2, n, card()));
    rod.clamp(0);
    RodStep step(rod);
    const VecX none = VecX::Zero(rod.dofs());
    for (int i = 0; i < 200; ++i) {  // 10 s: at rest
      step.advance(rod, 0.05, gravity, none, well_balanced);
    }
    const Vec3 tip = rod.poses(Configuration::current).back().position;
    // Exact heavy elastica (inextensible).
    const Real error = std::hypot(tip.x() - 94.596e-3, tip.z() + 163.283e-3);
    row("suture cantilever", n, error, 0.2, step_time(rod, step, 0.01, gravity, none));
  }
  struct Load {
    Real alpha, w, u;
  };  // elastica table, tests/reference/a01
  for (const Load l :
       {Load{1, 0.3017207738, 0.05643323628}, Load{10, 0.8106090249, 0.5549955978}}) {
    const Real length = 0.1;
    const Section s{.radius = 0.15e-3, .young = 2e9, .poisson = 0.4, .density = 1140};
    for (Index n = 4; n <= 256; n *= 2) {
      Rod rod;
      rod.build(straight_layout(length, n, s));
      rod.clamp(0);
      VecX force = VecX::Zero(rod.dofs());
      force[6 * n + 2] = -l.alpha * s.bending_stiffness() / (length * length);
      equilibrium(rod, Vec3::Zero(), force, 1e-10);
      RodStep step(rod);
      const Vec3 tip = rod.poses(Configuration::current).back().position;
      const Real error = std::hypot(-tip.z() - l.w * length, length - tip.x() - l.u * length);
      const std::string name = "elastica load " + std::to_string(static_cast<int>(l.alpha));
      row(name.c_str(), n, error, length, step_time(rod, step, 0.01, Vec3::Zero(), force));
    }
  }
}

void cost(std::FILE* csv) {
  std::fprintf(csv,
               "beams,assemble_ns,factor_ns,solve_ns,step_ns,factor_and_solve_ns,bytes_per_beam\n");
  std::printf("%8s %10s %10s %10s %10s   ns per beam\n", "beams", "assemble", "factor", "solve",
              "step");
  for (const Index n : {200, 500, 1000, 2000, 5000, 10000}) {
    Rod rod;
    rod.build(straight_layout(2e-3 * static_cast<Real>(n), n, card()));
    rod.clamp(0);
    RodStep step(rod);
    const VecX none = VecX::Zero(rod.dofs());
    for (int i = 0; i < 20; ++i) {
      step.advance(rod, 0.01, gravity, none, well_balanced);
    }
    const double per = 1e9 / static_cast<double>(n);
    const double whole = per * step_time(rod, step, 0.01, gravity, none);
    BlockTridiagonal matrix = step.matrix();
    const double assembly =
        per * best_time([&] { assemble(rod, step.start(), step.guess(), Tangent::exact, matrix); });
    const double factorise = per * best_time([&] { factor(matrix); });
    VecX x = VecX::Ones(rod.dofs());
    const double solve = per * best_time([&] { matrix.solve(Eigen::Ref<VecX>(x)); });
    // What one step goes through.
    const std::size_t bytes = matrix.bytes_per_block() + sizeof(ElementRest) + sizeof(ElementMass) +
                              sizeof(ElementState) + 2 * sizeof(Pose) + 4 * sizeof(Real) +
                              5 * sizeof(Vec6);
    std::fprintf(csv, "%ld,%.1f,%.1f,%.1f,%.1f,%.1f,%zu\n", static_cast<long>(n), assembly,
                 factorise, solve, whole, factorise + solve, bytes);
    std::printf("%8ld %10.1f %10.1f %10.1f %10.1f   %zu bytes\n", static_cast<long>(n), assembly,
                factorise, solve, whole, bytes);
  }
}

/// A step of the loop at rest between its held ends; with the sampling's look at every beam if it
/// is on.
double loop_step_time(Rod& rod, Real angle) {
  loop::hold_ends(rod, loop::tight);
  const VecX none = VecX::Zero(rod.dofs());
  RodStep step(rod);
  SamplingWork work;
  const SamplingRules rules = loop::rules(angle);
  return best_time([&] {
    if (step.advance(rod, 0.01, Vec3::Zero(), none, well_balanced) == 0) std::abort();
    if (angle > 0 && sample(rod, rules, work)) std::abort();
  });
}

void sampling(std::FILE* csv) {
  std::fprintf(
      csv,
      "sampling,angle_rad,beams,shortening_error,height_error,curvature_error,cpu_us_per_step\n");
  std::printf("%-9s %6s %6s %12s %12s %12s %12s\n", "loop", "angle", "beams", "shortening",
              "height", "curvature", "us per step");
  const auto row = [&](const char* kind, Rod& rod, Real angle) {
    const loop::Errors e = loop::errors(rod, loop::tight);
    const double us = 1e6 * loop_step_time(rod, angle);
    const auto beams = static_cast<long>(rod.beams());
    std::fprintf(csv, "%s,%g,%ld,%.4e,%.4e,%.4e,%.2f\n", kind, angle, beams, e.shortening, e.height,
                 e.curvature, us);
    std::printf("%-9s %6g %6ld %12.2e %12.2e %12.2e %12.2f\n", kind, angle, beams, e.shortening,
                e.height, e.curvature, us);
  };
  Rod rod;
  for (const Index beams : {100, 150, 200, 300, 400, 600, 800, 1200, 2400}) {
    rod = loop::laid_out(beams, loop::tight);
    if (loop::pull(rod, loop::tight)) row("uniform", rod, 0);
  }
  for (const Real angle : {0.8, 0.4, 0.3, 0.2, 0.15, 0.1, 0.07, 0.05})
    if (loop::pull_tight(rod, angle)) row("adaptive", rod, angle);
}

void start(std::FILE* csv) {
  std::fprintf(csv, "dt_s,error_m_after_20_s,mean_passes,cpu_us_per_step\n");
  for (const Real dt : {1e-3, 2e-3, 5e-3, 10e-3, 20e-3, 50e-3}) {
    Rod rod;
    rod.build(straight_layout(0.2, 50, card()));
    rod.clamp(0);
    RodStep step(rod);
    const VecX none = VecX::Zero(rod.dofs());
    const int steps = static_cast<int>(std::lround(20 / dt));
    Index passes = 0;
    const double t0 = cpu_seconds();
    for (int i = 0; i < steps; ++i) {
      passes += step.advance(rod, dt, gravity, none, well_balanced);
    }
    const double time = (cpu_seconds() - t0) / steps;
    const Vec3 tip = rod.poses(Configuration::current).back().position;
    const Real error = std::hypot(tip.x() - 94.596e-3, tip.z() + 163.283e-3);
    std::fprintf(csv, "%g,%.4e,%.3f,%.2f\n", dt, error, static_cast<double>(passes) / steps,
                 1e6 * time);
    std::printf(
        "card, 50 beams, dt %5.3f s: error %.4f mm after 20 s, %.3f passes, %.1f us per step\n", dt,
        1e3 * error, static_cast<double>(passes) / steps, 1e6 * time);
  }
}

}  // namespace
}  // namespace sutura::thread

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: sutura_bench_thread OUTPUT_FOLDER\n");
    return 1;
  }
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  const auto write = [&](const char* name, void (*part)(std::FILE*)) {
    std::FILE* csv = std::fopen((folder / name).c_str(), "w");
    if (!csv) {
      std::fprintf(stderr, "cannot write %s\n", (folder / name).c_str());
      std::exit(3);
    }
    part(csv);
    std::fclose(csv);
  };
  write("thread_cost.csv", sutura::thread::cost);
  write("thread_work_precision.csv", sutura::thread::work_precision);
  write("thread_sampling.csv", sutura::thread::sampling);
  write("thread_start.csv", sutura::thread::start);
}
