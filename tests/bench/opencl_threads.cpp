// Many threads at once: environments x steps per second, one CPU core beside them, and the error of
// the time step.
#include <cmath>
#include <cstdio>

#include "batch_on_cpu.h"
#include "opencl_bench.h"
#include "threads.h"

namespace sutura::opencl {
namespace {

/// A thread of 100 beams in a bow of 32 points, so high (m).
ThreadsProblem bow(Real height) {
  ThreadsProblem p;
  for (int k = 0; k < 32; ++k)
    for (const Real x : {0.03 + 0.0015 * k, 0., height * std::sin(k * std::numbers::pi / 31)})
      p.path.push_back(x);
  return p;
}

/// A pull of 37 mm/s that begins and ends smoothly within 0.4 s, aside too.
Vec3 pull(Real time) {
  const Real s = std::sin(std::numbers::pi * time / 0.4);
  return s * s * Vec3(0.03, 0.01, 0.02);
}

/// What is observed of one environment when it is pulled fastest, from rest in a straight path.
std::vector<Real> after(const Device& device, Real dt) {
  ThreadsProblem p = bow(0);
  p.dt = dt;
  Threads threads(device, p, 1);
  const int steps = static_cast<int>(std::lround(0.2 / dt));
  for (int i = 0; i < steps; ++i) {
    const Vec3 u = pull((i + 0.5) * dt);
    threads.step(std::vector<Real>{u.x(), u.y(), u.z()}, dt);
  }
  std::vector<Real> out(static_cast<std::size_t>(threads.observations()));
  threads.observe(out);
  return out;
}

}  // namespace

bool bench_threads(const Device& device, const std::filesystem::path& out) {
  if (!device.has_double()) return true;
  const ThreadsProblem p = bow(2e-3);
  std::ofstream csv(out / "threads.csv");
  csv << "environments,us a step,environments x steps a second,CPU steps a second\n";
  test::ThreadOnCpu cpu(p);
  Real time = 0;
  const double cpu_time = microseconds([&] {
    cpu.step(pull(time));
    time += p.dt;
  });
  std::printf(
      "\nThreads of 100 beams in 32 points of a path\nenvironments  us a step  environments x "
      "steps/s  one core: steps/s\n");
  for (const int count : {1, 16, 256, 1024, 4096}) {
    Threads threads(device, p, count);
    std::vector<Real> actions;
    for (int i = 0; i < count; ++i)
      for (const Real v : {0.03, 0.01, 0.02}) actions.push_back(v);
    const double step = microseconds([&] { threads.step(actions, p.dt); });
    std::printf("%12d %10.0f %22.0f %18.0f\n", count, step, 1e6 * count / step, 1e6 / cpu_time);
    std::fflush(stdout);
    csv << count << ',' << step << ',' << 1e6 * count / step << ',' << 1e6 / cpu_time << '\n';
    if (step > 2e6) break;  // no device for more
  }
  return static_cast<bool>(csv);
}

bool bench_threads_accuracy(const Device& device, const std::filesystem::path& out) {
  if (!device.has_double()) return true;
  const std::vector<Real> exact = after(device, 1e-4);
  const std::size_t first = exact.size() - 3 * 101;
  std::ofstream csv(out / "threads_accuracy.csv");
  csv << "dt ms,error of force mN,error of position mm\n";
  std::printf(
      "\nThreads: error after 0.2 s, against steps of 0.1 ms\n  dt/ms  force/mN  position/mm\n");
  for (const Real dt : {10e-3, 5e-3, 2e-3, 1e-3, 5e-4}) {
    const std::vector<Real> seen = after(device, dt);
    Real force = 0, position = 0;
    for (std::size_t i = 0; i < seen.size(); ++i)
      if (i < 3)
        force = std::max(force, std::abs(seen[i] - exact[i]));
      else if (i >= first)
        position = std::max(position, std::abs(seen[i] - exact[i]));
    std::printf("%7.1f %9.3f %12.4f\n", 1e3 * dt, 1e3 * force, 1e3 * position);
    csv << 1e3 * dt << ',' << 1e3 * force << ',' << 1e3 * position << '\n';
  }
  std::printf("  the force: %.1f mN\n", 1e3 * Vec3(exact[0], exact[1], exact[2]).norm());
  return static_cast<bool>(csv);
}

}  // namespace sutura::opencl
