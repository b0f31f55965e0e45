// What the asynchronous solver remembers from step to step. A factor is not saved but made again
// from the matrix behind it, which gives the same bits.
#include "async_solver.h"
#include "sutura/archive.h"

namespace sutura::tissue {

void NodeMatrix::archive(Archive& a) {
  const std::size_t size = values_.size();
  if (a.restoring())
    is_here_ = !(is_there_ = false);
  else
    bring();
  a("values", values_);
  if (values_.size() == size) return;
  values_.assign(size, 0);
  a.fail("the matrix of another mesh");
}

void Candidates::archive(Archive& a) {
  a("chosen", chosen_);
  a("is_chosen", is_chosen_);
  a("touched_at", touched_at_);
  a("outgrown", outgrown_);
  a("full_until", full_until_);
  for (const Index i : chosen_)
    if (i < 0 || i >= pattern_->nodes()) a.fail("a touched node of another mesh");
  if (is_chosen_.size() != fixed_.size() || touched_at_.size() != fixed_.size())
    a.fail("touched nodes of another mesh");
}

void RecentSolutions::archive(Archive& a) {
  MatX known = x_.leftCols(count_);
  a("solutions", known);
  a("next", next_);
  if (!a.restoring() || !a.ok()) return;
  if (known.cols() > most || next_ < 0 || next_ >= most) return a.fail("too many solutions");
  if (known.rows() != x_.rows()) return a.fail("solutions of another mesh");
  count_ = known.cols();
  matrix_changed();
  x_.leftCols(count_) = known;
}

void archive(Archive& a, TissueSolveReport& r) {
  a("iterations", r.iterations);
  a("residual", r.residual);
  a("factor_age", r.factor_age);
  a("adopted_at", r.adopted_at);
  a("failed_factors", r.failed_factors);
  a("converged", r.converged);
  a("stale", r.stale);
}

void archive(Archive& a, Snapshot& s) {
  s.A.archive(a);
  a("rotations", s.rotations);
  a("candidates", s.candidates);
  a("step", s.step);
  for (const Index i : s.candidates)
    if (i < 0 || i >= s.A.nodes()) a.fail("a candidate of another mesh");
  if (static_cast<Index>(s.rotations.size()) != s.A.nodes())
    a.fail("the rotations of another mesh");
}

void LearntNodes::archive(Archive& a, Index nodes) {
  a("learnt", node);
  a("portions", end);
  for (const Index i : node)
    if (i < 0 || i >= nodes) a.fail("a touched node of another mesh");
  Index before = 0;
  for (const Index e : end) {
    if (e <= before || e > before + GrowingCompliance::at_once) a.fail("portions that are none");
    before = e;
  }
  if (before != static_cast<Index>(node.size())) a.fail("portions of other nodes");
}

/// The snapshot of `job`, or that there is none.
void AsyncSolver::archive_job(Archive& a, std::shared_ptr<Snapshot>& snapshot) {
  bool exists = snapshot != nullptr;
  a("snapshot", exists);
  if (!exists || !a.ok()) {
    snapshot.reset();
    return;
  }
  if (a.restoring())
    snapshot = std::make_shared<Snapshot>(Snapshot{NodeMatrix(pattern_), {}, {}, -1});
  tissue::archive(a, *snapshot);
  snapshot->candidates.reserve(static_cast<std::size_t>(pattern_->nodes()));
}

void AsyncSolver::archive(Archive& a) {
  std::shared_ptr<Snapshot> in_use = current_ ? current_->snapshot : nullptr;
  archive_job(a, in_use);
  archive_job(a, in_flight_);
  LearntNodes learnt = current_ ? current_->compliance.learnt() : LearntNodes{};
  learnt.archive(a, pattern_->nodes());
  candidates_.archive(a);
  recent_.archive(a);
  a("last_iterations", last_iterations_);
  a("worker_lost", worker_lost_);
  tissue::archive(a, report_);
  a.list("adoptions", adoptions_, [](Archive& each, Adoption& adoption) {
    each("step", adoption.step);
    each("snapshot", adoption.snapshot);
  });
  if (!a.restoring()) return;
  jacobi_ready_ = false;
  worker_.reset();
  device_factor_ = nullptr;
  on_device_ = recent_on_device_ = false;
  current_.reset();
  spare_.reset();
  postponed_.reset();
  if (!a.ok()) {
    in_flight_.reset();
    return;
  }
  const auto job_of = [this](std::shared_ptr<Snapshot> snapshot) {
    auto job = std::make_unique<SnapshotFactor>();
    job->snapshot = std::move(snapshot);
    job->rough = rough();
    return job;
  };
  if (in_use) {
    current_ = job_of(std::move(in_use));
    ++compliance_id_;
    current_->factorise(plan_);
    if (!current_->ok) a.fail("the factor in use cannot be made again");
    current_->compliance.learn_again(std::move(learnt));
  }
  if (!in_flight_) return;
  if (worker_lost_)
    postponed_ = job_of(in_flight_);
  else
    submit(job_of(in_flight_));
}

}  // namespace sutura::tissue
