// Solvers of a tissue: time per step, iterations against age, compliance.
#include <fstream>
#include <numbers>

#include "async_solver.h"
#include "direct_solver.h"
#include "tissue_bench_parts.h"
#include "tissue_pad.h"

namespace sutura::bench {
namespace {

struct Result {
  double assembly = 0, cpu = 0, wall = 0, worst_wall = 0;
  Real iterations = 0, age = 0, residual = 0;
  Index steps = 0;
};

Result run(std::array<int, 3> cells, TissueSolver& solver, bool smoothed, double budget_ms) {
  Pad pad(cells, 0.004, {10e3, 0.45, 1000}, 0.016, smoothed);
  solver.analyse(pad.A.pattern(), pad.fixed, {});
  Result r;
  const Clock whole;
  constexpr Index warm_up = 3, most = 120;
  for (Index k = 0; k < warm_up + most; ++k) {
    const VecX pressed = pad.tool(k, 0.3);
    const Clock step;
    pad.step(solver, k, pressed);
    const double cpu = step.cpu_ms(), wall = step.wall_ms();
    if (k < warm_up) continue;
    r.cpu += cpu;
    r.wall += wall;
    r.worst_wall = std::max(r.worst_wall, wall);
    r.iterations += static_cast<Real>(solver.report().iterations);
    r.age += static_cast<Real>(solver.report().factor_age);
    r.residual = std::max(r.residual, solver.report().residual);
    ++r.steps;
    if (whole.wall_ms() > budget_ms) break;
    // A simulator waits for the next frame; the worker does not.
    while (step.wall_ms() < 16) {
      const timespec rest{0, 500000};
      nanosleep(&rest, nullptr);
    }
  }
  const Clock assembly;
  for (int k = 0; k < 5; ++k) pad.assemble();
  r.assembly = assembly.cpu_ms() / 5;
  const double n = static_cast<double>(r.steps);
  r.cpu /= n;
  r.wall /= n;
  r.iterations /= n;
  r.age /= n;
  return r;
}

}  // namespace

void tissue_steps(const std::string& folder, bool large) {
  std::ofstream csv(folder + "/tissue_steps.csv");
  csv << "nodes,tets,element,solver,assembly ms,cpu ms,wall ms,worst wall "
         "ms,iterations,age,residual,steps\n";
  std::printf(
      "pad under a moving tool, dt 16 ms, two solves a step, residual 1e-4; main worker only\n");
  std::printf("%6s %-9s %-18s %9s %8s %8s %8s %6s %6s %9s\n", "nodes", "element", "solver",
              "assembly", "cpu ms", "wall ms", "worst", "iter", "age", "residual");
  std::vector<std::array<int, 3>> sizes{{14, 14, 4}, {22, 22, 5}, {26, 26, 6}, {34, 34, 7}};
  if (large) sizes.push_back({44, 44, 9});
  for (const auto& cells : sizes) {
    const Index nodes = (cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1);
    for (const bool smoothed : {false, true})
      for (const char* name : {"direct cholmod", "async cholmod", "direct eigen", "async eigen"}) {
        const std::string solver_name(name);
        const bool eigen = solver_name.ends_with("eigen");
        // Eigen's factorisation takes seconds from here on; the smoothed element is charted in
        // tissue_cure.
        if ((eigen && (nodes > 6000 || smoothed)) || (smoothed && nodes > 6000)) continue;
        if (!has_backend(FactorBackend::cholmod) && !eigen) continue;
        const FactorBackend backend = eigen ? FactorBackend::eigen : FactorBackend::cholmod;
        std::unique_ptr<TissueSolver> solver;
        if (solver_name.starts_with("direct")) {
          solver = std::make_unique<SynchronousSolver>(backend);
        } else {
          AsyncOptions o;
          o.backend = backend;
          solver = std::make_unique<AsyncSolver>(o);
        }
        const Result r = run(cells, *solver, smoothed, 5000);
        const char* element = smoothed ? "smoothed" : "t4";
        std::printf("%6ld %-9s %-18s %9.2f %8.2f %8.2f %8.1f %6.1f %6.1f %9.1e\n",
                    static_cast<long>(nodes), element, name, r.assembly, r.cpu, r.wall,
                    r.worst_wall, r.iterations, r.age, r.residual);
        std::fflush(stdout);
        csv << nodes << ',' << 6 * cells[0] * cells[1] * cells[2] << ',' << element << ',' << name
            << ',' << r.assembly << ',' << r.cpu << ',' << r.wall << ',' << r.worst_wall << ','
            << r.iterations << ',' << r.age << ',' << r.residual << ',' << r.steps << '\n';
        csv.flush();
      }
  }
}

void tissue_age(const std::string& folder) {
  std::ofstream csv(folder + "/tissue_age.csv");
  csv << "state,h ms,preconditioner,iterations 1e-3,iterations 1e-6\n";
  std::printf(
      "beam of 3520 nodes clamped at one end: iterations to 1e-3 / 1e-6 with the factor of the "
      "rest state\n");
  const Real height = 0.02, length = 54 * height / 7, degree = std::numbers::pi / 180;
  struct State {
    const char* name;
    Real bend = 0, twist = 0, dent = 0;
  };
  const State states[] = {{"bend 30", 30, 0, 0},      {"bend 90", 90, 0, 0},
                          {"bend 180", 180, 0, 0},    {"twist 90", 0, 90, 0},
                          {"poke 6 mm", 0, 0, 0.006}, {"pull 5 mm", 0, 0, -0.005}};
  for (const Real h : {0.01, 0.04}) {
    Pad beam({54, 7, 7}, height / 7, {10e3, 0.45, 1000}, h, false);
    for (std::size_t i = 0; i < beam.fixed.size(); ++i)
      beam.fixed[i] = beam.mesh.points[i].x() < 1e-9;
    beam.assemble();
    beam.find_rotations();
    const std::vector<Mat3> then = beam.rotations, none(then.size(), Mat3::Identity());
    const auto factor =
        make_factor(make_factor_plan(beam.A.pattern(), beam.fixed, {}, default_backend()));
    factor->factorise(beam.A);
    VecX b = VecX::Zero(beam.x.size());
    for (Index i = 0; i < beam.nodes(); ++i) b[3 * i + 2] = beam.mass[static_cast<std::size_t>(i)];
    for (const State& s : states) {
      for (Index i = 0; i < beam.nodes(); ++i) {
        Vec3 X = beam.mesh.points[static_cast<std::size_t>(i)];
        X.z() -=
            s.dent * std::exp(-(X - Vec3(length / 2, height / 2, height)).squaredNorm() / 1e-4);
        if (s.bend != 0) {
          const Real radius = length / (s.bend * degree), r = radius - (X.z() - height / 2);
          X = Vec3(r * std::sin(X.x() / radius), X.y(),
                   height / 2 + radius - r * std::cos(X.x() / radius));
        }
        if (s.twist != 0) {
          const Vec3 axis(0, height / 2, height / 2);
          X = axis +
              Eigen::AngleAxis<Real>(s.twist * degree * X.x() / length, Vec3::UnitX()) * (X - axis);
        }
        beam.x.segment<3>(3 * i) = X;
      }
      beam.assemble();
      beam.find_rotations();
      WarpedFactor straight, turned;
      straight.set(*factor, none, none);
      turned.set(*factor, then, beam.rotations);
      BlockJacobi jacobi;
      jacobi.compute(beam.A, beam.fixed);
      std::printf("  h %2.0f ms  %-10s", 1e3 * h, s.name);
      const std::pair<const char*, const Preconditioner*> all[] = {
          {"diagonal", &jacobi}, {"old factor", &straight}, {"old factor, turned", &turned}};
      for (const auto& [name, P] : all) {
        Pcg pcg;
        GrowingMat x;
        const Index coarse = pcg.solve(beam.A, beam.fixed, *P, b, x, 1e-3, 2000).iterations;
        const Index fine = pcg.solve(beam.A, beam.fixed, *P, b, x, 1e-6, 2000).iterations;
        std::printf("   %s %ld / %ld", name, static_cast<long>(coarse), static_cast<long>(fine));
        csv << s.name << ',' << 1e3 * h << ',' << name << ',' << coarse << ',' << fine << '\n';
      }
      std::printf("\n");
    }
  }
}

void tissue_compliance(const std::string& folder) {
  std::ofstream csv(folder + "/tissue_compliance.csv");
  csv << "nodes,touched nodes,rows,method,cpu ms\n";
  Pad pad({34, 34, 7}, 0.004, {10e3, 0.45, 1000}, 0.016, false);
  BodyRows rows;
  rows.clear();
  const Vec3 middle(pad.size.x() / 2, pad.size.y() / 2, pad.size.z());
  std::vector<std::pair<Real, Index>> surface;
  for (Index i = 0; i < pad.nodes(); ++i) {
    const Vec3& p = pad.mesh.points[static_cast<std::size_t>(i)];
    if (p.z() > pad.size.z() - 1e-9) surface.emplace_back((p - middle).norm(), i);
  }
  std::sort(surface.begin(), surface.end());
  surface.resize(300);
  for (const auto& [distance, node] : surface)
    for (int c = 0; c < 3; ++c) {
      rows.row.push_back(static_cast<Index>(rows.row.size()));
      rows.node.push_back(node);
      for (int k = 0; k < 3; ++k) rows.value.push_back(k == c ? 1 : 0);
      rows.start.push_back(static_cast<Index>(rows.node.size()));
    }
  pad.assemble();
  pad.find_rotations();
  const auto measure = [&](const char* name, TissueSolver& solver) {
    MatX W = MatX::Zero(rows.size(), rows.size());
    const Clock clock;
    const Index solved = add_tissue_compliance(solver, rows, pad.h, W);
    const double ms = clock.cpu_ms();
    std::printf("  %-34s %8.1f ms of the main worker (%ld rows solved for)\n", name, ms,
                static_cast<long>(solved));
    csv << pad.nodes() << ",300," << rows.size() << ',' << name << ',' << ms << '\n';
    return W;
  };
  std::printf("compliance of 300 surface nodes, %ld nodes\n", static_cast<long>(pad.nodes()));
  SynchronousSolver direct;
  direct.analyse(pad.A.pattern(), pad.fixed, {});
  direct.prepare(pad.A, {}, 0);
  const MatX exact = measure("multi-column solves", direct);
  AsyncOptions o;
  o.lag = 1;
  AsyncSolver async(o);
  async.analyse(pad.A.pattern(), pad.fixed, {});
  MatX W;
  for (Index step = 0; step < 3; ++step) {
    async.prepare(pad.A, pad.rotations, step);
    async.touch(rows.node);
    if (step == 2) W = measure("published with the factor", async);
  }
  std::printf("  difference of the two W: %.1e\n", (W - exact).norm() / exact.norm());
}

}  // namespace sutura::bench
