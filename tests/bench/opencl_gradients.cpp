// Conjugate gradients of a tissue, on the device and on one core of the CPU.
#include <cstdio>

#include "gradients.h"
#include "opencl_bench.h"
#include "pcg.h"
#include "tissue_pad.h"

namespace sutura::opencl {
namespace {

using bench::Pad;

constexpr Real tolerance = 1e-4;  // the default of AsyncPreconditioner

/// A pad whose upper side has been turned by 30 degrees since its factor was made.
struct Twisted {
  explicit Twisted(std::array<int, 3> cells)
      : pad(cells, 0.004, {.young = 1e4, .poisson = 0.45, .density = 1000}, 0.016, false) {
    pad.assemble();
    factor = tissue::make_factor(
        tissue::make_factor_plan(pad.A.pattern(), pad.fixed, {}, tissue::default_backend()));
    factor->keep_rough();
    const bench::Clock clock;
    factor->factorise(pad.A);
    factor_ms = clock.wall_ms();
    for (Index i = 0; i < pad.nodes(); ++i) {
      Vec3 p = pad.x.segment<3>(3 * i) - pad.size / 2;
      const Real angle = 0.5 * pad.x[3 * i + 2] / pad.size.z();
      p = Eigen::AngleAxis<Real>(angle, Vec3::UnitZ()) * p;
      pad.x.segment<3>(3 * i) = p + pad.size / 2;
    }
    pad.assemble();
    pad.find_rotations();
  }
  Pad pad;
  std::unique_ptr<tissue::Factor> factor;
  double factor_ms = 0;
};

const std::array<int, 3> pads[] = {
    {16, 16, 6}, {25, 25, 7}, {35, 35, 8}, {45, 45, 9}, {63, 63, 12}};  // cells

bool is_larger(const std::array<int, 3>& cells, Index nodes) {
  return (cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1) > nodes;
}

}  // namespace

bool bench_gradients(const Device& device, const Limits& limits, const std::filesystem::path& out,
                     Index most_nodes) {
  std::ofstream csv(out / "gradients.csv");
  csv << "nodes,entries of L,precision,product us,product floor us,P^-1 us,P^-1 floor "
         "us,launches,solve us,"
         "iterations,CPU solve us,CPU iterations,matrix us,turns us,factor us\n";
  std::printf(
      "\nConjugate gradients to 1e-4, microseconds; floor: bytes over the bandwidth, launches\n"
      "  nodes  L [M] precision product floor     P^-1 floor launches    solve it      CPU it "
      "  matrix  turns   factor (made in ms)\n");
  for (const std::array<int, 3>& cells : pads) {
    if (is_larger(cells, most_nodes)) continue;
    const Twisted twisted(cells);
    const Pad& pad = twisted.pad;
    SupernodalFactor supernodes;
    if (!twisted.factor->supernodes(supernodes)) {
      std::printf("  this build has no supernodal factor (CHOLMOD): nothing to measure\n");
      return true;
    }
    VecX b = pad.tool(0, 1);
    const MatX none(b.size(), 0);  // solved before: both start from zero
    tissue::WarpedFactor warped;
    const std::vector<Mat3> then(pad.rotations.size(), Mat3::Identity());
    warped.set(*twisted.factor, then, pad.rotations, true);
    tissue::Pcg pcg;
    GrowingMat x;
    tissue::PcgReport cpu;
    const double cpu_time =
        microseconds([&] { cpu = pcg.solve(pad.A, pad.fixed, warped, b, x, tolerance, 200); });
    const NodeMatrixView view{pad.nodes(), pad.A.pattern()->row_start(), pad.A.pattern()->column(),
                              pad.A.values()};
    const double nodes = static_cast<double>(pad.nodes()),
                 slots = static_cast<double>(view.column.size()),
                 entries = static_cast<double>(supernodes.value.size());
    for (const Precision precision : {Precision::double_, Precision::mixed, Precision::single}) {
      if (precision != Precision::single && !device.has_double()) continue;
      Gradients gradients(device, precision);
      gradients.set_matrix(view, pad.fixed);
      const double factor = microseconds([&] { gradients.set_factor(supernodes); });
      const auto time = [&](const auto& work) {
        return microseconds([&] {
          work();
          device.finish();
        });
      };
      const double matrix = time([&] { gradients.set_matrix(view, pad.fixed); });
      const double turns = time([&] { gradients.set_turns(pad.rotations); });
      VecX answer = VecX::Zero(b.size());
      ConjugateGradientDevice::Report report;
      const double solve = microseconds([&] {
        answer.setZero();
        gradients.keep(none, 0);
        report = gradients.solve(b, answer, tolerance, 200);
      });
      // They stop where the iteration has ended, so it is begun anew.
      gradients.keep(none, 0);
      gradients.begin(b);
      const double product = time([&] {
                               for (int i = 0; i < 20; ++i) gradients.product();
                             }) /
                             20;
      const double apply = time([&] {
                             for (int i = 0; i < 5; ++i) gradients.precondition();
                           }) /
                           5;
      const double number = precision == Precision::single ? 4 : 8,
                   store = precision == Precision::double_ ? 8 : 4;
      const double launches = static_cast<double>(gradients.solves().launches() + 2);
      // Every block is read for its own row and that of its transpose; indices are two ints each.
      const double product_floor =
          limits.launch +
          (slots * 9 * store + 2 * slots * 8 + nodes * 6 * number) / limits.bandwidth;
      const double apply_floor =
          launches * limits.launch + (2 * entries * 4 + nodes * 30 * number) / limits.bandwidth;
      std::printf(
          "%7.0f %6.1f %-9s %7.1f %5.1f %8.1f %5.0f %8.0f %8.0f %2td %8.0f %2td %8.0f %6.0f %8.0f "
          "(%.0f)\n",
          nodes, entries / 1e6, word(precision), product, product_floor, apply, apply_floor,
          launches, solve, report.iterations, cpu_time, cpu.iterations, matrix, turns, factor,
          twisted.factor_ms);
      std::fflush(stdout);
      csv << nodes << ',' << entries << ',' << word(precision) << ',' << product << ','
          << product_floor << ',' << apply << ',' << apply_floor << ',' << launches << ',' << solve
          << ',' << report.iterations << ',' << cpu_time << ',' << cpu.iterations << ',' << matrix
          << ',' << turns << ',' << factor << '\n';
    }
  }
  return static_cast<bool>(csv);
}

bool bench_gradients_accuracy(const Device& device, const std::filesystem::path& out,
                              Index most_nodes) {
  std::ofstream csv(out / "gradients_accuracy.csv");
  csv << "nodes,precision,asked,iterations,residual,error of x\n";
  std::printf(
      "\nConjugate gradients; residual |b - A x| / |b| as it is, error |x - x*| / |x*|\n"
      "  nodes precision   asked it  residual     error\n");
  for (const std::array<int, 3>& cells : pads) {
    if (is_larger(cells, most_nodes)) continue;
    const Twisted twisted(cells);
    const Pad& pad = twisted.pad;
    SupernodalFactor supernodes;
    if (!twisted.factor->supernodes(supernodes)) return true;  // bench_gradients has said so
    // x*: a factor of this matrix in double precision, and its residual solved for once more.
    const VecX b = pad.tool(0, 1);
    const auto now = tissue::make_factor(
        tissue::make_factor_plan(pad.A.pattern(), pad.fixed, {}, tissue::default_backend()));
    now->factorise(pad.A);
    MatX exact = b, rest = b;
    VecX product;
    const auto residual_of = [&](const VecX& x) {
      pad.A.multiply(x, product);
      VecX r = b - product;
      for (Index i = 0; i < pad.nodes(); ++i)
        if (pad.fixed[static_cast<std::size_t>(i)]) r.segment<3>(3 * i).setZero();
      return r;
    };
    now->solve(exact);
    rest = residual_of(exact);
    now->solve(rest);
    exact += rest;
    for (const Precision precision : {Precision::double_, Precision::mixed, Precision::single}) {
      if (precision != Precision::single && !device.has_double()) continue;
      Gradients gradients(device, precision);
      gradients.set_matrix(
          {pad.nodes(), pad.A.pattern()->row_start(), pad.A.pattern()->column(), pad.A.values()},
          pad.fixed);
      gradients.set_factor(supernodes);
      gradients.set_turns(pad.rotations);
      for (const Real asked : {tolerance, 1e-8}) {
        VecX x = VecX::Zero(b.size());
        gradients.keep(MatX(b.size(), 0), 0);
        const auto report = gradients.solve(b, x, asked, 200);
        const Real residual = residual_of(x).norm() / b.norm(),
                   error = (x - exact).norm() / exact.norm();
        std::printf("%7td %-9s %7.0e %2td %9.1e %9.1e\n", pad.nodes(), word(precision), asked,
                    report.iterations, residual, error);
        std::fflush(stdout);
        csv << pad.nodes() << ',' << word(precision) << ',' << asked << ',' << report.iterations
            << ',' << residual << ',' << error << '\n';
      }
    }
  }
  return static_cast<bool>(csv);
}

}  // namespace sutura::opencl
