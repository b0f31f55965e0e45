// What the rows of a thread cost the solver, by length of the thread, number of rows and form of
// its compliance.
#include "solver_compliance.h"

#include <chrono>
#include <cstdio>
#include <fstream>
#include <functional>
#include <random>

#include "solve/gauss_seidel.h"
#include "thread_problems.h"

namespace sutura {
namespace {

/// Microseconds, best of some rounds.
Real best_time(const std::function<void()>& f) {
  Real best = 1e30, spent = 0;
  for (int round = 0; round < 200 && (round < 5 || spent < 2e4); ++round) {
    const auto before = std::chrono::steady_clock::now();
    f();
    const Real us =
        std::chrono::duration<Real, std::micro>(std::chrono::steady_clock::now() - before).count();
    best = std::min(best, us);
    spent += us;
  }
  return best;
}

struct Cost {
  Real compliance, prepare, sweep, product, system, solve;  // us
  Index products;                                           // of 6 x 6 blocks in one sweep
  SolveReport report;
};

Cost measure(const test::ThreadPathOptions& options, ComplianceForm form) {
  test::ThreadPath path(options);
  ConstraintProblem problem;
  path.build(problem, form);
  std::vector<ComplianceReport> reports(2);
  ComplianceStage stage;
  Cost cost;
  cost.compliance =
      best_time([&] { stage.run(path.bodies, problem, options.dt, form, {}, reports); });

  Compliance compliance;
  cost.prepare = best_time([&] { compliance.prepare(problem); });
  cost.product = best_time([&] { compliance.update_delta(problem); });
  // Visits as a sweep makes them, without the laws, in a fixed shuffled order.
  std::vector<std::size_t> order(problem.blocks.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::mt19937_64 random(1);
  std::shuffle(order.begin(), order.end(), random);
  const auto sweep = [&] {
    compliance.begin_sweep();
    for (const std::size_t i : order) {
      Real delta[max_block_dim];
      compliance.displacement(problem, i, delta);
      for (int k = 0; k < problem.blocks[i].law->dim; ++k)
        delta[k] = 1e-9 * std::copysign(1, delta[k]);
      compliance.add_change(problem, i, delta);
    }
    compliance.end_sweep(problem);
  };
  const auto products = [&] {
    return compliance.has_operators() ? compliance.operators()[0].products() : 0;
  };
  const Index before = products();
  sweep();
  cost.products = products() - before;
  cost.sweep = best_time(sweep);
  // The system of a direct step over all rows.
  const Mat3 unit = Mat3::Identity();
  std::vector<RowCombination> all;
  for (std::size_t i = 0; i < problem.blocks.size(); ++i)
    for (int k = 0; k < problem.blocks[i].law->dim; ++k)
      all.push_back({i, unit.col(k).data(), unit.col(k).data(), problem.blocks[i].first_row + k});
  MatX G(problem.rows(), problem.rows());
  cost.system = best_time([&] {
    G.setZero();
    compliance.add_products(problem, all, true, G);
  });
  cost.solve = 0;
  if (!options.tissue)
    return cost;  // a thread that nothing holds but its own path: no problem of a step
  // From the forces of a slightly smaller pull, as in the step after.
  BlockGaussSeidel solver;
  const VecX d_free = problem.d_free;
  problem.d_free *= 0.98;
  solver.solve(problem);
  const VecX before_lambda = problem.lambda;
  problem.d_free = d_free;
  cost.solve = best_time([&] {
    problem.lambda = before_lambda;
    cost.report = solver.solve(problem);
  });
  return cost;
}

}  // namespace

bool bench_compliance(const std::filesystem::path& out) {
  std::ofstream csv(out / "solver_compliance.csv");
  csv << "beams,rows,tissue,form,compliance us,prepare us,sweep us,product us,system us,warm solve "
         "us,sweeps,direct,"
         "factorisations,residual,6x6 products per sweep\n";
  std::printf("%6s %6s %7s %-10s %10s %8s %8s %8s %8s %10s   (us)\n", "beams", "rows", "tissue",
              "form", "compliance", "prepare", "sweep", "product", "system", "warm solve");
  for (const bool tissue : {false, true})
    for (const Index beams : {200, 1000, 5000})
      for (const Index rows : {30, 60, 150, 300, 450, 600, 1200, 2400})
        for (const ComplianceForm form : {ComplianceForm::assembled, ComplianceForm::as_operator}) {
          if (rows / 3 + 30 > beams || (rows > 600 && (tissue || beams < 5000))) continue;
          const Cost c = measure({.beams = beams, .samples = rows / 3, .tissue = tissue}, form);
          const char* name = form == ComplianceForm::assembled ? "assembled" : "operator";
          csv << beams << ',' << rows << ',' << tissue << ',' << name << ',' << c.compliance << ','
              << c.prepare << ',' << c.sweep << ',' << c.product << ',' << c.system << ','
              << c.solve << ',' << c.report.sweeps << ',' << c.report.direct_solves << ','
              << c.report.factorisations << ',' << c.report.residual << ',' << c.products << '\n';
          std::printf(
              "%6td %6td %7d %-10s %10.1f %8.1f %8.2f %8.2f %8.1f %10.1f   %td sweeps %td direct "
              "%td matrices, %.1e\n",
              beams, rows, tissue, name, c.compliance, c.prepare, c.sweep, c.product, c.system,
              c.solve, c.report.sweeps, c.report.direct_solves, c.report.factorisations,
              c.report.residual);
        }
  return static_cast<bool>(csv);
}

}  // namespace sutura
