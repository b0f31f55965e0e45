// A whole step of a tissue under 300 contacts with friction: what takes how long, on one core and
// with a device.
#include <Eigen/Eigenvalues>
#include <cstdio>
#include <map>
#include <memory>

#include "gradients_alone.h"
#include "opencl_bench.h"
#include "pressed_pad.h"
#include "sweeps_alone.h"

namespace sutura::opencl {
namespace {

using bench::PressedPad;

constexpr Real frame = 1.0 / 60;  // s, and the length of a step
constexpr double budget = 10;     // s, for each way, beyond the first steps
constexpr int warm_up = 6;        // steps

struct Way {
  const char* name;
  bool gradients, sweeps;
};
constexpr Way ways[] = {
    {"CPU", false, false}, {"device", true, false}, {"device, contacts too", true, true}};

const std::array<int, 3> pads[] = {{25, 25, 7}, {45, 45, 9}, {63, 63, 12}};  // cells

Index nodes_of(const std::array<int, 3>& cells) {
  return (cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1);
}

/// A pad that a device works for.
struct Arena {
  Arena(const Device& device, Precision precision, std::array<int, 3> cells)
      : gradients(device, precision),
        sweeps(device, precision),
        gradients_alone(gradients),
        sweeps_alone(sweeps, precision),
        pad(cells, 0.004, frame) {}
  void begin(const Way& way, bool felt) {
    pad.begin(way.gradients ? &gradients_alone : nullptr, way.sweeps ? &sweeps_alone : nullptr,
              felt);
  }
  Gradients gradients;
  Sweeps sweeps;
  GradientsAlone gradients_alone;
  SweepsAlone sweeps_alone;
  PressedPad pad;
};

struct Sum {
  PressedPad::StepCost cost;
  double worst = 0;
  int steps = 0, unsolved = 0;
  std::string message;

  void add(const PressedPad::StepCost& c) {
    for (std::size_t i = 0; i < c.ms.size(); ++i) cost.ms[i] += c.ms[i];
    cost.total += c.total;
    for (const auto member : counts) cost.*member += c.*member;
    worst = std::max(worst, c.total);
    unsolved += c.solved ? 0 : 1;
    ++steps;
    if (!c.message.empty()) message = c.message;
  }
  double mean(double of_all) const { return of_all / std::max(steps, 1); }
  static constexpr Index PressedPad::StepCost::*counts[] = {
      &PressedPad::StepCost::passes,  &PressedPad::StepCost::iterations,
      &PressedPad::StepCost::outside, &PressedPad::StepCost::age,
      &PressedPad::StepCost::sweeps,  &PressedPad::StepCost::direct};
};

Sum run(PressedPad& pad) {
  Sum sum;
  bench::Clock all;
  constexpr int most = 240;
  for (int k = 0; k < most && all.wall_ms() < 1000 * budget; ++k) {
    const bench::Clock step;
    const PressedPad::StepCost cost = pad.step();
    while (step.wall_ms() < 1000 * frame) {  // the worker does not wait for the next frame
      const timespec rest{0, 200000};
      nanosleep(&rest, nullptr);
    }
    if (k < warm_up)
      all = {};
    else
      sum.add(cost);
  }
  return sum;
}

/// Bytes that every kernel of conjugate gradients has to read and write, per iteration.
std::map<std::string, double> bytes_of(const Gradients& gradients,
                                       const tissue::NodePattern& pattern) {
  const Schedule& s = gradients.solves().schedule();
  std::vector<char> in_subtree(s.panels.size(), 0);
  for (const std::int32_t n : s.subtree) in_subtree[static_cast<std::size_t>(n)] = 1;
  double levels = 0, subtrees = 0;  // entries of L
  for (std::size_t n = 0; n < s.panels.size(); ++n) {
    const double w = s.panels[n].width, h = s.panels[n].height;
    (in_subtree[n] ? subtrees : levels) += w * h - w * (w - 1) / 2;
  }
  const auto nodes = static_cast<double>(pattern.nodes()),
             slots = static_cast<double>(pattern.slots());
  return {{"solve_forward", 4 * levels},
          {"solve_back", 4 * levels},
          {"solve_subtrees", 4 * subtrees},
          {"solve_back_subtrees", 4 * subtrees},
          {"product", slots * 88 + nodes * 48},
          {"turn", nodes * 144},
          {"turn_back", nodes * 120},
          {"direction", nodes * 72},
          {"advance", nodes * 144}};
}

/// What the kernels take in some steps, on a device that says so.
void time_kernels(const DeviceChoice& choice, const Limits& limits, std::array<int, 3> cells,
                  std::ofstream& csv) {
  DeviceChoice timed = choice;
  timed.timed = true;
  Device device(timed);
  Arena arena(device, choose(Precision::automatic, device), cells);
  arena.begin(ways[2], true);
  for (int k = 0; k < warm_up; ++k) arena.pad.step();
  device.take_times();
  constexpr int steps = 10;
  for (int k = 0; k < steps; ++k) arena.pad.step();
  const auto bytes = bytes_of(arena.gradients, arena.pad.pattern());
  const std::vector<KernelTime> times = device.take_times();
  const auto advance = std::ranges::find(times, "advance", &KernelTime::name);
  const double iterations = advance == times.end() ? 0 : advance->launches;
  std::printf(
      "%td nodes, kernels: launches a step, us a step, floor (bytes over the bandwidth), launches' "
      "own us\n",
      arena.pad.nodes());
  for (const KernelTime& t : times) {
    const auto known = bytes.find(t.name);
    const double floor =
        known == bytes.end() ? 0 : known->second * iterations / limits.bandwidth / steps;
    const double launches = static_cast<double>(t.launches) / steps;
    std::printf("  %-22s %7.1f %9.1f %9.1f %9.1f\n", t.name.c_str(), launches, t.us / steps, floor,
                launches * limits.launch);
    csv << arena.pad.nodes() << ',' << t.name << ',' << launches << ',' << t.us / steps << ','
        << floor << ',' << launches * limits.launch << '\n'
        << std::flush;
  }
  std::fflush(stdout);
}

}  // namespace

bool bench_step_kernels(const DeviceChoice& choice, const Limits& limits,
                        const std::filesystem::path& out, Index most_nodes) {
  std::ofstream csv(out / "step_kernels.csv");
  csv << "nodes,kernel,launches a step,us a step,floor us,launches us\n";
  for (const std::array<int, 3>& cells : pads)
    if (nodes_of(cells) <= most_nodes) time_kernels(choice, limits, cells, csv);
  return static_cast<bool>(csv);
}

bool bench_step(const DeviceChoice& choice, const std::filesystem::path& out, Index most_nodes) {
  std::ofstream csv(out / "step.csv");
  csv << "nodes,way,steps,passes,iterations,columns solved for,age,sweeps,factorisations";
  for (const char* name : PressedPad::stage_names) csv << ',' << name << " ms";
  csv << ",step ms,worst ms,unsolved\n";
  std::printf(
      "\nA whole step of 1/60 s, %d contacts with friction; ms, means over the steps after the "
      "first %d\n  nodes way                steps passes   it columns age sweeps direct",
      PressedPad::contacts, warm_up);
  for (const char* name : PressedPad::stage_names) std::printf(" %10s", name);
  std::printf(" %9s %9s unsolved\n", "step", "worst");
  const Device device(choice);
  const auto fits = [&](const std::array<int, 3>& cells) { return nodes_of(cells) <= most_nodes; };
  for (const std::array<int, 3>& cells : pads) {
    if (!fits(cells)) continue;
    for (const Way& way : ways) {
      const auto arena =
          std::make_unique<Arena>(device, choose(Precision::automatic, device), cells);
      arena->begin(way, true);
      const Sum sum = run(arena->pad);
      std::printf("%7td %-18s %5d", arena->pad.nodes(), way.name, sum.steps);
      csv << arena->pad.nodes() << ",\"" << way.name << "\"," << sum.steps;
      const char* const forms[] = {" %6.1f", " %4.0f", " %7.0f", " %3.0f", " %6.0f", " %6.1f"};
      for (std::size_t i = 0; i < std::size(forms); ++i) {
        const double mean = sum.mean(static_cast<double>(sum.cost.*Sum::counts[i]));
        std::printf(forms[i], mean);
        csv << ',' << mean;
      }
      for (const double ms : sum.cost.ms) {
        std::printf(" %10.2f", sum.mean(ms));
        csv << ',' << sum.mean(ms);
      }
      std::printf(" %9.2f %9.2f %d %s\n", sum.mean(sum.cost.total), sum.worst, sum.unsolved,
                  sum.message.c_str());
      std::fflush(stdout);
      csv << ',' << sum.mean(sum.cost.total) << ',' << sum.worst << ',' << sum.unsolved << '\n'
          << std::flush;
    }
  }
  return static_cast<bool>(csv);
}

bool bench_compliance_accuracy(const Device& device, const std::filesystem::path& out,
                               Index most_nodes) {
  std::ofstream csv(out / "compliance_accuracy.csv");
  csv << "nodes,precision,error of W,error in the worst direction,condition of W\n";
  std::printf(
      "\nW of %d contacts, learnt from a factor in single precision; |W - W*| / |W*|, largest "
      "|v.(W - W*) v| / v.W* v, condition of W*\n  nodes precision     error     worst condition\n",
      PressedPad::contacts);
  for (const std::array<int, 3>& cells : pads) {
    if (nodes_of(cells) > most_nodes) continue;
    const auto compliance = [&](const Way& way, Precision precision) -> MatX {
      Arena arena(device, precision, cells);
      arena.begin(way, false);
      return arena.pad.first_compliance();
    };
    const MatX exact = compliance(ways[0], Precision::single);  // of the CPU: always in double
    const VecX eigenvalues = exact.selfadjointView<Eigen::Lower>().eigenvalues();
    for (const Precision precision : {Precision::double_, Precision::mixed, Precision::single}) {
      if (precision != Precision::single && !device.has_double()) continue;
      const MatX wrong = compliance(ways[1], precision) - exact;
      const Eigen::GeneralizedSelfAdjointEigenSolver<MatX> directions(wrong, exact,
                                                                      Eigen::EigenvaluesOnly);
      const Real error = wrong.norm() / exact.norm(),
                 worst = directions.eigenvalues().cwiseAbs().maxCoeff(),
                 condition = eigenvalues.maxCoeff() / eigenvalues.minCoeff();
      std::printf("%7td %-9s %9.1e %9.1e %9.1e\n", nodes_of(cells), word(precision), error, worst,
                  condition);
      std::fflush(stdout);
      csv << nodes_of(cells) << ',' << word(precision) << ',' << error << ',' << worst << ','
          << condition << '\n';
    }
  }
  return static_cast<bool>(csv);
}

bool bench_step_accuracy(const Device& device, const std::filesystem::path& out, Index most_nodes) {
  std::ofstream csv(out / "step_accuracy.csv");
  csv << "nodes,precision,error of lambda\n";
  constexpr int steps = 8;
  constexpr Index passes = 8;
  std::printf(
      "\nForces of %d contacts after %d steps of %td passes; error: largest of lambda over the "
      "largest force\n  nodes precision     error\n",
      PressedPad::contacts, steps, passes);
  for (const std::array<int, 3>& cells : pads) {
    if (nodes_of(cells) > most_nodes) continue;
    const auto forces = [&](const Way& way, Precision precision, Real tolerance) -> VecX {
      Arena arena(device, precision, cells);
      arena.pad.set_passes(passes, tolerance);
      arena.begin(way, false);
      for (int k = 0; k < steps; ++k) arena.pad.step();
      return arena.pad.forces();
    };
    const VecX exact = forces(ways[0], Precision::single, 1e-9);  // of the CPU: always in double
    // To what conjugate gradients get in each.
    for (const auto& [precision, tolerance] : {std::pair{Precision::double_, 1e-9},
                                               {Precision::mixed, 1e-6},
                                               {Precision::single, 1e-5}}) {
      if (precision != Precision::single && !device.has_double()) continue;
      const Real error = (forces(ways[2], precision, tolerance) - exact).lpNorm<Eigen::Infinity>() /
                         exact.lpNorm<Eigen::Infinity>();
      std::printf("%7td %-9s %9.1e\n", nodes_of(cells), word(precision), error);
      std::fflush(stdout);
      csv << nodes_of(cells) << ',' << word(precision) << ',' << error << '\n';
    }
  }
  return static_cast<bool>(csv);
}

}  // namespace sutura::opencl
