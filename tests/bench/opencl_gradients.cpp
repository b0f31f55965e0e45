#include "opencl_bench.h"
namespace sutura::opencl {
bool bench_gradients(const Device&, const Limits&, const std::filesystem::path&) { return true; }
}
