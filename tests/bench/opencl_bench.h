// What the parts of the OpenCL benchmark share: the clock, and what the device can do at best.
#pragma once

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>

#include "program.h"

namespace sutura::opencl {

/// Microseconds that `work` takes: the least of several tries, each of as many calls as fill a
/// millisecond or so.
template <class Work>
double microseconds(const Work& work) {
  using Clock = std::chrono::steady_clock;
  const auto time = [&](int calls) {
    const auto begin = Clock::now();
    for (int i = 0; i < calls; ++i) work();
    return std::chrono::duration<double, std::micro>(Clock::now() - begin).count() / calls;
  };
  const double first = time(1);
  const int calls = std::clamp(static_cast<int>(2000 / first), 1, 1000);
  double best = time(calls), spent = 0;
  for (int i = 0; i < 7 && spent < 1e6; ++i) {
    const double now = time(calls);
    spent += now * calls;
    best = std::min(best, now);
  }
  return best;
}

inline const char* word(Precision p) {
  return p == Precision::double_ ? "double" : p == Precision::mixed ? "mixed" : "single";
}

/// Measured.
struct Limits {
  double launch = 0;      ///< us, of a kernel that does nothing, in a full queue
  double round_trip = 0;  ///< us, of one and a blocking read of 4 bytes
  double barrier = 0;     ///< us, of a barrier in a work-group of 320 items
  double bandwidth = 0;   ///< bytes per us, reading 256 MiB
};
Limits measure_limits(const Device& device);

/// Sweeps: a table, and sweeps.csv.
bool bench_sweeps(const Device& device, const Limits& limits, const std::filesystem::path& out);
/// Conjugate gradients: a table, and gradients.csv.
bool bench_gradients(const Device& device, const Limits& limits, const std::filesystem::path& out,
                     Index most_nodes);
/// Whole steps of a tissue under 300 contacts: tables, step.csv and step_kernels.csv.
bool bench_step(const DeviceChoice& choice, const std::filesystem::path& out, Index most_nodes);
bool bench_step_kernels(const DeviceChoice& choice, const Limits& limits,
                        const std::filesystem::path& out, Index most_nodes);
/// What the precisions cost in accuracy; any device will do. sweeps_accuracy.csv,
/// gradients_accuracy.csv, compliance_accuracy.csv, step_accuracy.csv.
bool bench_sweeps_accuracy(const Device& device, const std::filesystem::path& out);
bool bench_gradients_accuracy(const Device& device, const std::filesystem::path& out,
                              Index most_nodes);
bool bench_compliance_accuracy(const Device& device, const std::filesystem::path& out,
                               Index most_nodes);
bool bench_step_accuracy(const Device& device, const std::filesystem::path& out, Index most_nodes);
/// Many threads at once: threads.csv; the error of their time step: threads_accuracy.csv.
bool bench_threads(const Device& device, const std::filesystem::path& out);
bool bench_threads_accuracy(const Device& device, const std::filesystem::path& out);

}  // namespace sutura::opencl
