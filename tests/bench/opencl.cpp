// The kernels of the OpenCL plugin against what the device can do at best, and one CPU core beside
// them.
//
//   sutura_bench_opencl OUT_DIR [PART OF A DEVICE'S NAME [MOST NODES
//     [sweeps|gradients|step|kernels|threads|accuracy]]]
#include <cstdio>
#include <cstdlib>

#include "opencl_bench.h"

namespace sutura::opencl {

namespace {

const char* const probes = R"(
kernel void nothing(global int* x) { if (get_global_id(0) == 1000000) x[0] = 1; }
kernel void barriers(int count, global int* x) {
  local int last;
  for (int i = 0; i < count; ++i) {
    if (get_local_id(0) == i % get_local_size(0)) last = i;
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  if (get_local_id(0) == 0) x[0] = last;
}
kernel void read(global const float4* from, int each, global float* x) {
  float4 sum = 0;
  for (int i = 0; i < each; ++i) sum += from[(size_t)i * get_global_size(0) + get_global_id(0)];
  if (sum.x + sum.y + sum.z + sum.w == 1) x[0] = 1;
}
)";

}  // namespace

Limits measure_limits(const Device& device) {
  Program program(device, Precision::single, probes);
  Limits out;
  Kernel &nothing = program["nothing"], &barriers = program["barriers"], &read = program["read"];
  Buffer x(device), large(device);
  constexpr std::size_t bytes = std::size_t{256} << 20;
  x.reserve(16);
  large.reserve(bytes);
  out.launch = microseconds([&] {
                 for (int i = 0; i < 200; ++i) nothing(64, 64, x);
                 device.finish();
               }) /
               200;
  out.round_trip = microseconds([&] {
    int word = 0;
    nothing(64, 64, x);
    x.read(&word, sizeof(word));
  });
  const auto rounds = [&](int count) {
    return microseconds([&] {
      barriers(320, 320, count, x);
      device.finish();
    });
  };
  out.barrier = std::max(0.0, (rounds(11000) - rounds(1000)) / 10000);
  constexpr std::size_t items = 1 << 18;
  const double time = microseconds([&] {
    for (int i = 0; i < 4; ++i) read(items, 256, large, static_cast<cl_int>(bytes / 16 / items), x);
    device.finish();
  });
  out.bandwidth = 4 * static_cast<double>(bytes) / time;
  return out;
}

}  // namespace sutura::opencl

int main(int argc, char** argv) {
  using namespace sutura::opencl;
  const std::string part = argc > 4 ? argv[4] : "";
  if (argc < 2 || (!part.empty() && part != "sweeps" && part != "gradients" && part != "step" &&
                   part != "kernels" && part != "threads" && part != "accuracy")) {
    std::fprintf(stderr,
                 "usage: sutura_bench_opencl OUT_DIR [PART OF A DEVICE'S NAME [MOST NODES "
                 "[sweeps|gradients|step|kernels|threads|accuracy]]]\n");
    return 1;
  }
  try {
    const DeviceChoice choice{.name = argc > 2 ? argv[2] : ""};
    const Device device(choice);
    const std::filesystem::path out = argv[1];
    std::filesystem::create_directories(out);
    const sutura::Index most_nodes = argc > 3 ? std::atol(argv[3]) : 60000;
    std::printf("%s\n", device.name().c_str());
    std::ofstream(out / "device.txt") << device.name() << '\n';
    const auto wanted = [&](const char* name) { return part.empty() || part == name; };
    bool done = true;
    if (wanted("step")) done = bench_step(choice, out, most_nodes) && done;
    if (wanted("sweeps") || wanted("gradients") || wanted("kernels")) {
      const Limits limits = measure_limits(device);
      std::printf(
          "launch %.1f us, launch and read %.1f us, barrier of 320 items %.3f us, reading %.0f "
          "GB/s\n",
          limits.launch, limits.round_trip, limits.barrier, limits.bandwidth / 1000);
      if (wanted("sweeps")) done = bench_sweeps(device, limits, out) && done;
      if (wanted("gradients")) done = bench_gradients(device, limits, out, most_nodes) && done;
      if (wanted("kernels")) done = bench_step_kernels(choice, limits, out, most_nodes) && done;
    }
    if (wanted("threads")) done = bench_threads(device, out) && done;
    if (wanted("accuracy"))
      done = bench_threads_accuracy(device, out) && bench_sweeps_accuracy(device, out) &&
             bench_gradients_accuracy(device, out, most_nodes) &&
             bench_compliance_accuracy(device, out, most_nodes) &&
             bench_step_accuracy(device, out, most_nodes) && done;
    return done ? 0 : 3;
  } catch (const sutura::DeviceError& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
}
