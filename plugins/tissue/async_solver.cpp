#include "async_solver.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace sutura::tissue {

AsyncSolver::~AsyncSolver() = default;

void AsyncSolver::analyse(std::shared_ptr<const NodePattern> pattern, std::span<const char> fixed,
                          std::span<const Index> candidates) {
  worker_.reset();
  current_.reset();
  spare_.reset();
  in_flight_.reset();
  postponed_.reset();
  worker_lost_ = false;
  device_factor_ = nullptr;
  on_device_ = recent_on_device_ = false;
  adoptions_.clear();
  adoptions_.reserve(4096);
  pattern_ = std::move(pattern);
  const Index n = 3 * pattern_->nodes();
  pcg_.reserve(n);
  recent_.reset(n);
  single_x_.resize(n);
  columns_.resize(n, Factor::columns_at_once);
  for (VecX* v : {&asked_, &answered_}) v->resize(n);
  fixed_.assign(fixed.begin(), fixed.end());
  candidates_.reset(pattern_, fixed, candidates);
  plan_ = make_factor_plan(pattern_, fixed_, candidates_.chosen(), options_.backend,
                           options_.resources.cache.get());
  report_ = {};
  last_iterations_ = 0;
}

void AsyncSolver::prepare(const NodeMatrix& A, std::span<const Mat3> rotations, Index step,
                          bool same) {
  assert(plan_ && A.pattern() == pattern_);
  A_ = &A;
  step_ = step;
  rotations_.assign(rotations.begin(), rotations.end());
  if (!same) {
    jacobi_ready_ = false;
    recent_.matrix_changed();
  }
  const Index failed = report_.failed_factors, adopted = report_.adopted_at,
              analyses = report_.analyses;
  report_ = {};
  report_.analyses = analyses;
  report_.failed_factors = failed;
  report_.adopted_at = adopted;

  adopt_what_is_due();
  if (!current_ || renew_) factorise_here();
  renew_ = false;
  if (!in_flight_ && wants_new_factor()) {
    auto job = take_snapshot();
    in_flight_ = job->snapshot;
    if (worker_lost_)
      postponed_ = std::move(job);
    else
      submit(std::move(job));
  }
  last_iterations_ = 0;
  if (current_) {
    warped_.set(*current_->factor, current_->snapshot->rotations, rotations_, rough());
    report_.factor_age = step_ - current_->snapshot->step;
    report_.stale = report_.factor_age > options_.max_age;
    if (report_.stale)
      report_.complain("the worker is late: the factor is " + std::to_string(report_.factor_age) +
                       " steps old");
  }
  on_device_ = device_ != nullptr && give_to_device(same);
}

/// What this step needs is sent to the device: matrix and factor only if they are others. False if
/// the CPU shall do it.
bool AsyncSolver::give_to_device(bool same_matrix) {
  const auto give = [&] {
    if (!current_) return false;
    const bool is_there = A_->is_there() || (same_matrix && on_device_);
    if (!is_there && !device_->set_matrix(view_of(*A_), fixed_)) return false;
    if (device_factor_ != current_->factor.get() || device_snapshot_ != current_->snapshot->step) {
      SupernodalFactor factor;
      if (!current_->factor->supernodes(factor)) {
        report_.complain("the factor has no supernodes (backend \"eigen\"): not for the device");
        return false;
      }
      if (!device_->set_factor(factor)) return false;
      device_factor_ = current_->factor.get();
      device_snapshot_ = current_->snapshot->step;
    }
    if (A_->is_there()) return device_->find_turns(current_->snapshot->rotations);
    return device_->set_turns(warped_.turns());
  };
  const bool given = give();
  if (!given && !device_->why_not().empty()) report_.complain(device_->why_not());
  return given;
}

/// answered_ <- A^-1 asked_. False if the CPU shall do it.
bool AsyncSolver::solve_on_device(Real tolerance) {
  ConjugateGradientDevice::Report r;
  recent_on_device_ = recent_on_device_ || device_->keep(recent_.all(), recent_.next());
  if (!recent_on_device_ ||
      !device_->solve(asked_, answered_, tolerance, options_.max_iterations, r)) {
    report_.complain(device_->why_not());
    on_device_ = recent_on_device_ = false;
    return false;
  }
  report_.iterations += r.iterations;
  last_iterations_ = std::max(last_iterations_, r.iterations);
  if (!r.converged) return false;
  recent_.add(answered_);
  report_.residual = std::max(report_.residual, r.residual);
  return true;
}

void AsyncSolver::submit(std::unique_ptr<SnapshotFactor> job) {
  if (!worker_)
    worker_ = std::make_unique<FactorWorker>(plan_, options_.resources.pool, options_.hook);
  worker_->submit(std::move(job));
}

/// A copy of the matrix of this step, in recycled memory.
std::unique_ptr<SnapshotFactor> AsyncSolver::take_snapshot() {
  auto job = spare_ ? std::move(spare_) : std::make_unique<SnapshotFactor>();
  if (!job->snapshot)
    job->snapshot = std::make_shared<Snapshot>(Snapshot{*A_, {}, {}, -1});
  else
    job->snapshot->A = *A_;
  job->snapshot->candidates.reserve(static_cast<std::size_t>(A_->nodes()));
  job->rough = rough();
  job->snapshot->rotations = rotations_;
  if (candidates_.outgrown()) candidates_.choose(step_);
  job->snapshot->candidates = candidates_.chosen();
  job->snapshot->step = step_;
  return job;
}

bool AsyncSolver::wants_new_factor() const {
  if (!current_) return false;  // factorise_here has just failed on this very matrix
  if (current_->snapshot->step == step_) return false;
  if (!options_.replay.empty())
    return std::any_of(options_.replay.begin(), options_.replay.end(), [&](const Adoption& a) {
      return a.snapshot == step_ && a.step > a.snapshot;
    });
  return last_iterations_ > options_.refactor_iterations || candidates_.outgrown() ||
         4 * (step_ - current_->snapshot->step) >= 3 * options_.max_age;  // in time for the worker
}

bool AsyncSolver::is_due() const {
  if (!options_.replay.empty())
    return std::find(options_.replay.begin(), options_.replay.end(),
                     Adoption{step_, in_flight_->step}) != options_.replay.end();
  return options_.lag < 0 || step_ >= in_flight_->step + options_.lag;
}

void AsyncSolver::adopt_what_is_due() {
  if (!in_flight_ || !is_due()) return;
  std::unique_ptr<SnapshotFactor> fresh;
  if (!worker_lost_)
    fresh =
        worker_->take(std::chrono::duration<double>(adoption_is_fixed() ? options_.patience : 0));
  if (!fresh) {
    if (!adoption_is_fixed()) return;
    if (worker_lost_) {
      fresh = std::move(postponed_);
    } else {
      // The lost worker may still read its snapshot: nobody else will be given that one.
      worker_lost_ = true;
      report_.complain("the worker did not answer: factorising in the step from now on");
      fresh = std::make_unique<SnapshotFactor>();
      fresh->snapshot = std::make_shared<Snapshot>(*in_flight_);
      fresh->rough = rough();
    }
    if (fresh->factorise(plan_)) ++report_.analyses;
  }
  in_flight_.reset();
  adopt(std::move(fresh));
}

void AsyncSolver::adopt(std::unique_ptr<SnapshotFactor> fresh) {
  if (!fresh->ok) {
    ++report_.failed_factors;
    report_.complain("the matrix of step " + std::to_string(fresh->snapshot->step) +
                     " is not positive definite" + (current_ ? ": keeping the older factor" : ""));
    spare_ = std::move(fresh);
    return;
  }
  // A factor made here in the meantime may be younger than what the worker was asked for.
  if (current_ && current_->snapshot->step > fresh->snapshot->step) {
    spare_ = std::move(fresh);
    return;
  }
  if (current_) spare_ = std::move(current_);
  current_ = std::move(fresh);
  ++compliance_id_;
  report_.adopted_at = step_;
  adoptions_.push_back({step_, current_->snapshot->step});
}

/// Factorises the matrix of this step, now.
bool AsyncSolver::factorise_here() {
  auto fresh = take_snapshot();
  if (fresh->factorise(plan_)) ++report_.analyses;
  const bool ok = fresh->ok;
  adopt(std::move(fresh));
  if (ok) {
    warped_.set(*current_->factor, current_->snapshot->rotations, rotations_, rough());
    report_.factor_age = 0;
    report_.stale = false;
  }
  return ok;
}

const Preconditioner& AsyncSolver::preconditioner() {
  if (current_) return warped_;
  if (!jacobi_ready_) jacobi_.compute(*A_, fixed_);
  jacobi_ready_ = true;
  return jacobi_;
}

void AsyncSolver::solve(Eigen::Ref<MatX> columns, Real enough) {
  assert(A_);
  const bool single = columns.cols() == 1;
  const Real size = columns.norm();
  const Real tolerance =
      size > 0 ? std::clamp(enough / size, options_.tolerance, Real(0.5)) : options_.tolerance;
  if (single) asked_ = columns.col(0);
  if (single && on_device_ && solve_on_device(tolerance)) {
    columns.col(0) = answered_;
    return;
  }
  GrowingMat& x = single ? single_x_ : x_;
  const bool started = single && recent_.start(*A_, fixed_, asked_, x);
  PcgReport r = pcg_.solve(*A_, fixed_, preconditioner(), columns, x, tolerance,
                           options_.max_iterations, started);
  report_.iterations += r.iterations;
  last_iterations_ = std::max(last_iterations_, r.iterations);
  const bool older = current_ && current_->snapshot->step != step_;
  if (!r.converged && older && factorise_here()) {
    report_.complain(
        "the older factor was too poor: the matrix of the step was factorised at once");
    on_device_ = on_device_ && give_to_device(true);
    r = pcg_.solve(*A_, fixed_, preconditioner(), columns, x, tolerance, options_.max_iterations);
    report_.iterations += r.iterations;
  }
  report_.residual = std::max(report_.residual, r.residual);
  if (!r.converged) {
    report_.converged = false;
    report_.complain(current_ ? "conjugate gradients did not converge"
                              : "no factor, and conjugate gradients did not converge without one");
  }
  columns = x;
  if (single) {
    answered_ = x.col(0);
    recent_.add(answered_);
    recent_on_device_ = false;
  }
}

/// The factor turned to now is symmetric and positive definite, and so is what is made of it.
void AsyncSolver::solve_as_compliance(Eigen::Ref<MatX> columns) {
  if (!current_) return solve(columns);
  clear_fixed(fixed_, columns);
  warped_.apply(columns);
  clear_fixed(fixed_, columns);
}

/// Those that the factor in use does not know yet are learnt at once.
Index AsyncSolver::touch(std::span<const Index> nodes) {
  candidates_.touch(nodes, step_);
  if (!current_) return 0;
  return current_->compliance.learn(nodes, fixed_, [this](auto rows, auto columns, auto entries) {
    entries_of_inverse(rows, columns, entries);
  });
}

/// Of the factorised matrix, between unknowns of the whole tissue.
void AsyncSolver::entries_of_inverse(std::span<const Index> rows, std::span<const Index> columns,
                                     Eigen::Ref<MatX> entries) {
  if (on_device_) {
    if (device_->entries_of_inverse(rows, columns, entries)) return;
    report_.complain(device_->why_not());
    on_device_ = false;
  }
  const auto all = static_cast<Index>(columns.size());
  for (Index first = 0; first < all; first += Factor::columns_at_once) {
    const Index count = std::min(Factor::columns_at_once, all - first);
    columns_.setZero(3 * pattern_->nodes(), count);
    for (Index c = 0; c < count; ++c) columns_(columns[static_cast<std::size_t>(first + c)], c) = 1;
    current_->factor->solve(columns_);
    for (Index c = 0; c < count; ++c)
      for (std::size_t r = 0; r < rows.size(); ++r)
        entries(static_cast<Index>(r), first + c) = columns_(rows[r], c);
  }
}

NodeCompliance AsyncSolver::compliance() const {
  return current_ ? current_->compliance.view(current_->snapshot->rotations, rotations_)
                  : NodeCompliance{};
}

bool AsyncSolver::add_on_device(const SparseRows& rows, Real scale, Eigen::Ref<MatX> W) {
  if (!on_device_ || !current_) return false;
  const NodeCompliance::Matrix C = compliance().C;
  if (device_->add_compliance({compliance_id_, C.data(), C.rows(), C.outerStride()}, rows, scale,
                              W))
    return true;
  report_.complain(device_->why_not());
  on_device_ = false;
  return false;
}

}  // namespace sutura::tissue
