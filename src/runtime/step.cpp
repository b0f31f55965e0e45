// The time step: what happens, in which order. docs/step.md explains each stage.
#include "base/stage_timer.h"
#include "solve/compliance_check.h"
#include "solve/compliance_stage.h"
#include "sutura/simulation.h"

namespace sutura {

const StepReport& Simulation::step() {
  const StepContext context{
      .dt = scene_->dt, .time = report_.time, .step = report_.step, .gravity = scene_->gravity};
  StageTimer timer(report_.seconds);

  // Tracks and graspers say where the tools are at the end of the step, loads what they weigh.
  timer.enter(Stage::inputs);
  for (const NamedBody& b : bodies_) b.body->load().setZero(b.body->dofs());
  for (Driver* driver : drivers_) driver->drive(context);

  // Every body alone, as if nothing touched it: A dv = b, x_free.
  timer.enter(Stage::free_motion);
  for (const NamedBody& b : bodies_) b.body->free_motion(context);

  // Who might touch whom, from x and x_free.
  timer.enter(Stage::detect);
  for (ConstraintSource* source : sources_) source->detect(context);

  // Rows: H, d_free, law, parameters, key.
  timer.enter(Stage::build);
  builder_->begin();
  for (ConstraintSource* source : sources_) source->build(context, *builder_);
  builder_->finish();
  report_.blocks = static_cast<Index>(problem_.blocks.size());
  report_.rows = problem_.rows();

  // W = h^2 H A^-1 H^T: assembled, or an operator where the body is a chain and that is cheaper.
  timer.enter(Stage::compliance);
  compliance_->run(const_bodies_, problem_, context.dt, solver_->compliance_form(), report_.solve,
                   report_.compliance);

  // lambda and the state of every block.
  timer.enter(Stage::solve);
  report_.solve = problem_.rows() > 0 ? solver_->solve(problem_) : SolveReport{};
  report_.compliance_error = report_.first_compliance_error = 0;
  if (problem_.rows() > 0 && has_approximate_body()) check_compliance(context);

  // dv += h A^-1 H^T lambda; positions.
  timer.enter(Stage::correct);
  report_.finite = true;
  report_.messages.clear();
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    body_force_[i].setZero(bodies_[i].body->dofs());
    problem_.bodies[i].add_transposed(problem_.lambda, body_force_[i]);
    bodies_[i].body->correct(context, body_force_[i]);
    report_.finite = report_.finite && bodies_[i].body->finite();
    const std::string trouble = bodies_[i].body->trouble();
    if (!trouble.empty()) report_.messages.push_back(bodies_[i].path + ": " + trouble);
  }

  // Path points, punctures: the only place where topology changes. A state that is no longer finite
  // is not searched.
  timer.enter(Stage::commit);
  if (report_.finite) {
    const SolvedBlocks solved(problem_);
    for (ConstraintSource* source : sources_) source->commit(context, solved);
  }

  report_.step = context.step + 1;
  report_.time = static_cast<Real>(report_.step) * context.dt;

  // Files. Read-only.
  timer.enter(Stage::record);
  for (Recorder* recorder : recorders_) {
    if (recording_ && record_error_.empty()) record_error_ = recorder->record(*this, report_);
  }
  return report_;
}

bool Simulation::has_approximate_body() const {
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    if (problem_.bodies[i].size() > 0 && !bodies_[i].body->compliance_is_exact()) return true;
  return false;
}

/// W of some body is approximate: measures what lambda really does, and if that is more than a
/// micrometre from what W said, takes the difference into d_free and solves once more.
void Simulation::check_compliance(const StepContext& context) {
  constexpr Real tolerance = 1e-6;  // m; a hundredth of the length unit of most blocks
  const VecX d_free = problem_.d_free;
  VecX error;
  report_.compliance_error = compliance_error(const_bodies_, problem_, d_free, context.dt, error);
  report_.first_compliance_error = report_.compliance_error;
  if (report_.compliance_error <= tolerance) return;
  problem_.d_free += error;
  const Index events = report_.solve.events;
  report_.solve = solver_->solve(problem_);
  report_.solve.events += events;
  report_.compliance_error = compliance_error(const_bodies_, problem_, d_free, context.dt, error);
}

double StepReport::total_seconds() const {
  double sum = 0;
  for (const double s : seconds) sum += s;
  return sum;
}

}  // namespace sutura
