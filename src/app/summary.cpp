#include "app/summary.h"

#include <algorithm>
#include <cctype>
#include <cstdarg>
#include <cstdio>

namespace sutura::app {

namespace {

__attribute__((format(printf, 2, 3))) void append(std::string& out, const char* format, ...) {
  char line[200];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  out += line;
}

}  // namespace

void Summary::add(const StepReport& report) {
  if (steps_++ == 0) missed_before_ = report.missed_steps - (report.missed() ? 1 : 0);
  last_step_ = report.step;
  time_ = report.time;
  for (std::size_t i = 0; i < seconds_.size(); ++i) seconds_[i] += report.seconds[i];
  passes_ += report.passes;
  most_passes_ = std::max(most_passes_, report.passes);
  if (report.parts > 1) ++divided_;
  most_parts_ = std::max(most_parts_, report.parts);
  if (report.order == 2) ++of_second_order_;
  if (!report.solved) {
    if (unsolved_++ == 0) first_unsolved_ = report.step;
    worst_violation_ = std::max(worst_violation_, report.violation);
    worst_time_error_ = std::max(worst_time_error_, report.worst_time_error());
    for (const BodyReport& b : report.bodies) {
      if (b.imbalance.relative <= worst_imbalance_.relative) continue;
      worst_imbalance_ = b.imbalance;
      worst_body_ = b.body;
    }
  }
  events_ += report.solve.events;
  count(faults_, report.faults, report.step);
  count(notes_, report.messages, report.step);
  if (report.solved && !report.faults.empty()) ++faulty_;
  blocks_.add(static_cast<double>(report.blocks), report.step);
  rows_.add(static_cast<double>(report.rows), report.step);
  sweeps_.add(static_cast<double>(report.solve.sweeps), report.step);
  residual_.add(report.solve.residual, report.step);
  violation_.add(report.violation, report.step);
  Real force = 0;
  for (const BodyReport& b : report.bodies) force = std::max(force, b.imbalance.force);
  imbalance_.add(force, report.step);
  time_error_.add(report.worst_time_error(), report.step);
}

void Summary::count(std::map<std::string, Kind>& kinds, const std::vector<std::string>& sentences,
                    Index step) {
  for (const std::string& sentence : sentences) {
    std::string text = sentence;
    std::erase_if(text, [](unsigned char c) { return std::isdigit(c) != 0 || c == '.'; });
    Kind& kind = kinds[text];
    if (kind.steps == 0) {
      kind.first = sentence;
      kind.first_step = step;
    }
    if (kind.last_step != step) ++kind.steps;  // parts of a step may say the same
    kind.last_step = step;
  }
}

std::string Summary::text(double wall_seconds) const {
  std::string out;
  // A run that goes on from a state has not simulated what was before it.
  const Real simulated =
      steps_ > 0 ? time_ * static_cast<Real>(steps_) / static_cast<Real>(last_step_) : 0;
  append(out, "%ld step%s, %.4g s simulated in %.4g s", static_cast<long>(steps_),
         steps_ == 1 ? "" : "s", simulated, wall_seconds);
  if (simulated > 0) append(out, " (%.3g times real time)", wall_seconds / simulated);
  out += '\n';
  if (steps_ == 0) return out;

  double total = 0;
  for (const double s : seconds_) total += s;
  const double n = static_cast<double>(steps_);
  append(out, "\n  %-12s %10s %8s\n", "stage", "ms/step", "share");
  for (std::size_t i = 0; i < seconds_.size(); ++i)
    append(out, "  %-12s %10.4f %7.1f%%\n", std::string(stage_names[i]).c_str(),
           1e3 * seconds_[i] / n, total > 0 ? 100 * seconds_[i] / total : 0.0);
  append(out, "  %-12s %10.4f\n", "total", 1e3 * total / n);

  append(out, "\n  %-15s %12s %12s %10s\n", "constraints", "last", "largest", "at step");
  const auto row = [&out](const char* name, const Track& t) {
    append(out, "  %-15s %12.4g %12.4g %10ld\n", name, t.last, t.worst,
           static_cast<long>(t.worst_step));
  };
  row("blocks", blocks_);
  row("rows", rows_);
  row("sweeps", sweeps_);
  row("residual", residual_);
  row("violation [m]", violation_);
  row("imbalance [N]", imbalance_);
  row("time error [m]", time_error_);
  append(out,
         "  %.3g passes a step, at most %ld; %ld of %ld steps divided, into at most %ld parts\n",
         static_cast<double>(passes_) / n, static_cast<long>(most_passes_),
         static_cast<long>(divided_), static_cast<long>(steps_), static_cast<long>(most_parts_));
  if (of_second_order_ > 0)
    append(out,
           "  %ld of %ld steps in which threads may look back two steps (second order in time)\n",
           static_cast<long>(of_second_order_), static_cast<long>(steps_));
  append(out, "  %ld events (a surface pierced, a sticking sample torn loose)\n",
         static_cast<long>(events_));
  if (unsolved_ > 0) {
    append(out,
           "  TOLERANCE MISSED in %ld of %ld steps, first in step %ld: imbalance up to %.2g of the "
           "forces at work (%.2g N) of ",
           static_cast<long>(unsolved_), static_cast<long>(steps_),
           static_cast<long>(first_unsolved_), worst_imbalance_.relative, worst_imbalance_.force);
    out += worst_body_;
    append(out, ", violation up to %.2g m, time error up to %.2g m\n", worst_violation_,
           worst_time_error_);
  }
  if (missed_before_ > 0)
    append(out,
           "  MISSED BEFORE: %ld of the %ld steps before this run were less accurate than asked, "
           "or faulty\n",
           static_cast<long>(missed_before_), static_cast<long>(last_step_ - steps_));
  const auto list = [&](const char* title, const std::map<std::string, Kind>& kinds) {
    for (const auto& [text, kind] : kinds) {
      append(out, "  %s in %ld of %ld steps, first in step %ld: ", title,
             static_cast<long>(kind.steps), static_cast<long>(steps_),
             static_cast<long>(kind.first_step));
      out += kind.first + '\n';  // of any length
    }
  };
  list("FAULT", faults_);
  list("note", notes_);
  return out;
}

}  // namespace sutura::app
