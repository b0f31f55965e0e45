// A sweep of Gauss-Seidel, on the device and on one core of the CPU.
#include <cmath>
#include <cstdio>
#include <random>

#include "opencl_bench.h"
#include "solve/gauss_seidel.h"
#include "solve_problems.h"
#include "sutura/laws/coulomb.h"
#include "sweeps.h"
#include "sweeps_alone.h"

namespace sutura::opencl {
namespace {

/// Contacts with friction along a line, coupled as through tissue: W falls with the distance. About
/// half of them slide.
ConstraintProblem contacts(int count) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<Real> some(-1, 1);
  ConstraintProblem p;
  for (int i = 0; i < count; ++i) test::append<Coulomb>(p, {.mu = 0.3});
  const Index rows = 3 * count;
  MatX W(rows, rows);
  VecX d(rows);
  for (Index j = 0; j < rows; ++j) {
    for (Index i = 0; i < rows; ++i) {
      const Real apart = std::abs(static_cast<Real>(i / 3 - j / 3));
      W(i, j) = (i % 3 == j % 3 ? 0.01 : 0.001) * std::exp(-apart / 3);
    }
    W(j, j) += 0.005;
    d[j] = j % 3 == 0 ? -1e-3 : 5e-4 * some(random);
  }
  test::finish(p, W, d);
  return p;
}

std::vector<std::uint32_t> orders_of(int blocks, int sweeps) {
  std::mt19937 random(1);
  std::vector<std::uint32_t> out;
  for (int s = 0; s < sweeps; ++s) {
    const auto first = static_cast<std::ptrdiff_t>(out.size());
    for (int i = 0; i < blocks; ++i) out.push_back(static_cast<std::uint32_t>(i));
    std::shuffle(out.begin() + first, out.end(), random);
  }
  return out;
}

}  // namespace

bool bench_sweeps(const Device& device, const Limits& limits, const std::filesystem::path& out) {
  std::ofstream csv(out / "sweeps.csv");
  csv << "contacts,precision,way,us a sweep,floor us,us with transfers,us to load,CPU us a sweep\n";
  std::printf(
      "\nGauss-Seidel, microseconds a sweep; floor: W over the bandwidth, barriers, launches\n"
      "contacts precision way          sweep    floor  sweeps/s  one call     load       CPU\n");
  for (const int count : {50, 100, 300, 600, 1000, 2000}) {
    const ConstraintProblem start = contacts(count);
    ConstraintProblem p = start;
    BlockGaussSeidel cpu(
        {.tolerance = 1e-300, .sweeps = count < 500 ? 20 : 4, .acceleration = Acceleration::none});
    const double cpu_time = microseconds([&] {
                              p.lambda.setZero();
                              cpu.solve(p);
                            }) /
                            static_cast<double>(cpu.options().sweeps);
    for (const Precision precision : {Precision::double_, Precision::mixed, Precision::single}) {
      if (precision != Precision::single && !device.has_double()) continue;
      for (const bool panels : {false, true}) {
        const int most = static_cast<int>(std::min<std::size_t>(device.largest_group(), 1024));
        if (!panels && count > most) continue;
        Sweeps sweeps(device, precision, panels ? 0 : 1024);
        constexpr int at_once = 8;
        const auto orders = orders_of(count, at_once), one = orders_of(count, 1);
        p = start;
        try {
          const double load = microseconds([&] {
            sweeps.load(start);
            device.finish();
          });
          sweeps.send(p, orders);
          const double time = microseconds([&] {
                                sweeps.run(at_once);
                                device.finish();
                              }) /
                              at_once;
          const double call = microseconds([&] { sweeps.sweep(p, one); });
          const double bytes = 9.0 * count * count * (precision == Precision::double_ ? 8 : 4);
          const double floor =
              bytes / limits.bandwidth +
              (panels ? limits.launch * (count / 32 + 1) : limits.launch / at_once) +
              limits.barrier * count;
          std::printf("%8d %-9s %-9s %9.1f %8.1f %9.0f %9.1f %8.0f %9.1f\n", count, word(precision),
                      panels ? "panels" : "one group", time, floor, 1e6 / time, call, load,
                      cpu_time);
          std::fflush(stdout);
          csv << count << ',' << word(precision) << ',' << (panels ? "panels" : "one group") << ','
              << time << ',' << floor << ',' << call << ',' << load << ',' << cpu_time << '\n';
        } catch (const DeviceError& e) {  // too many registers, say
          std::printf("%8d %-9s %-9s %s\n", count, word(precision), panels ? "panels" : "one group",
                      e.what());
        }
      }
    }
  }
  return static_cast<bool>(csv);
}

bool bench_sweeps_accuracy(const Device& device, const std::filesystem::path& out) {
  std::ofstream csv(out / "sweeps_accuracy.csv");
  csv << "contacts,precision,error of lambda,law residual\n";
  std::printf(
      "\nGauss-Seidel, 400 sweeps; error: largest of lambda over the largest force\n"
      "contacts precision     error  residual\n");
  for (const int count : {50, 100, 300, 600, 1000}) {
    const ConstraintProblem start = contacts(count);
    // On the CPU, with the direct step: nothing of the device in it.
    ConstraintProblem exact = start;
    BlockGaussSeidel cpu({.tolerance = 1e-14});
    const Real left = cpu.solve(exact).residual;
    std::printf("%8d %-9s %9s %9.1e\n", count, "CPU", "", left);
    for (const Precision precision : {Precision::double_, Precision::mixed, Precision::single}) {
      if (precision != Precision::single && !device.has_double()) continue;
      Sweeps sweeps(device, precision);
      SweepsAlone alone(sweeps, precision);
      BlockGaussSeidel solver(
          {.tolerance = 1e-300, .sweeps = 400, .acceleration = Acceleration::none});
      solver.set_device(&alone);
      ConstraintProblem p = start;
      const Real residual = solver.solve(p).residual;
      const Real error = (p.lambda - exact.lambda).lpNorm<Eigen::Infinity>() /
                         exact.lambda.lpNorm<Eigen::Infinity>();
      std::printf("%8d %-9s %9.1e %9.1e\n", count, word(precision), error, residual);
      std::fflush(stdout);
      csv << count << ',' << word(precision) << ',' << error << ',' << residual << '\n';
    }
  }
  return static_cast<bool>(csv);
}

}  // namespace sutura::opencl
