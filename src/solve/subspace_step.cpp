#include "solve/subspace_step.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace sutura {

void SubspaceStep::begin() {
  factored_ = false;
  same_ = false;
}

Index SubspaceStep::gather(const ConstraintProblem& problem, const DiagonalBlocks& diagonal,
                           const VecX& lambda_plus) {
  now_.entries.clear();
  now_.directions.clear();
  now_.compliance.clear();
  symmetric_ = true;
  if (gap_.size() < problem.rows()) gap_.resize(problem.rows());
  for (std::size_t i = 0; i < problem.blocks.size(); ++i) {
    const ConstraintBlock& b = problem.blocks[i];
    const int dim = b.law->dim;
    const Real* W = diagonal[i];
    // What the block itself sees at lambda_plus: the pair is on its law's graph.
    Real delta[max_block_dim], plus[max_block_dim];
    for (int k = 0; k < dim; ++k) plus[k] = lambda_plus[b.first_row + k];
    for (int k = 0; k < dim; ++k) {
      delta[k] = problem.delta[b.first_row + k];
      for (int j = 0; j < dim; ++j)
        delta[k] += W[k + j * dim] * (plus[j] - problem.lambda[b.first_row + j]);
    }
    Mode mode = b.mode;
    FreeDirectionsView free;
    b.law->free_directions({W, delta, problem.block_params(b), &mode, plus}, free);
    for (int j = 0; j < free.count; ++j) {
      Direction direction{now_.entries.size(), 0, static_cast<Index>(i), j};
      for (int k = 0; k < dim; ++k) {
        const Entry entry{b.first_row + k, free.move[k + j * dim], free.test[k + j * dim]};
        if (entry.move != 0 || entry.test != 0) now_.entries.push_back(entry);
        if (entry.move != entry.test) symmetric_ = false;
      }
      direction.end = now_.entries.size();
      gap_[static_cast<Index>(now_.directions.size())] = free.gap[j];
      now_.directions.push_back(direction);
      for (int k = 0; k < max_block_dim; ++k)
        now_.compliance.push_back(k < free.count ? free.compliance[k + j * dim] : Real(0));
    }
  }
  same_ = factored_ && now_ == factored_with_;
  return static_cast<Index>(now_.directions.size());
}

void SubspaceStep::assemble(const ConstraintProblem& problem) {
  const auto f = static_cast<Index>(now_.directions.size());
  if (matrix_.rows() < f) matrix_.resize(f, f);
  if (column_.size() < problem.rows()) column_.resize(problem.rows());
  for (Index j = 0; j < f; ++j) {
    const Direction& dj = now_.directions[static_cast<std::size_t>(j)];
    auto w = column_.head(problem.rows());
    w.setZero();
    for (std::size_t e = dj.first; e < dj.end; ++e)
      if (now_.entries[e].move != 0)
        w += now_.entries[e].move * problem.W.col(now_.entries[e].row);
    for (Index i = symmetric_ ? j : 0; i < f; ++i) {
      const Direction& di = now_.directions[static_cast<std::size_t>(i)];
      Real g = 0;
      for (std::size_t e = di.first; e < di.end; ++e)
        g += now_.entries[e].test * w[now_.entries[e].row];
      if (di.block == dj.block)
        g += now_.compliance[static_cast<std::size_t>(j) * max_block_dim +
                             static_cast<std::size_t>(di.index)];
      matrix_(i, j) = g;
    }
  }
}

bool SubspaceStep::factorise() {
  const auto f = static_cast<Index>(now_.directions.size());
  auto G = matrix_.topLeftCorner(f, f);
  // Unit diagonal: rows of different compliance weigh the same, and a regularisation is relative to each. It is the share
  // of each row's own compliance that may be lost; repeating the step corrects it.
  scale_.resize(f);
  for (Index i = 0; i < f; ++i) scale_[i] = G(i, i) != 0 ? 1 / std::sqrt(std::abs(G(i, i))) : Real(1);
  if (!scale_.allFinite()) return false;
  G.array().colwise() *= scale_.array();
  G.array().rowwise() *= scale_.transpose().array();
  constexpr Real regularisation = 1e-12;
  G.diagonal().array() += regularisation;
  if (symmetric_) {

    Eigen::Ref<MatX, 0, Eigen::OuterStride<>> in_place(G);
    Eigen::LLT<Eigen::Ref<MatX, 0, Eigen::OuterStride<>>> llt(in_place);
    return llt.info() == Eigen::Success;
  }
  lu_.compute(G);
  return true;
}

bool SubspaceStep::solve(ConstraintProblem& problem, const VecX& lambda_plus) {
  const auto f = static_cast<Index>(now_.directions.size());
  problem.lambda = lambda_plus;
  problem.delta = problem.d_free;
  problem.delta.noalias() += problem.W * problem.lambda;
  if (f == 0) return true;
  if (!unchanged()) {
    assemble(problem);
    factored_ = factorise();
    if (!factored_) return false;
    factored_with_ = now_;
    same_ = true;
  }
  y_.resize(f);
  Real asked = 0;
  for (Index j = 0; j < f; ++j) {
    const Direction& d = now_.directions[static_cast<std::size_t>(j)];
    Real r = gap_[j];
    for (std::size_t e = d.first; e < d.end; ++e)
      r += now_.entries[e].test * problem.delta[now_.entries[e].row];
    y_[j] = -r * scale_[j];
    asked = std::max(asked, std::abs(y_[j]));
  }
  if (symmetric_) {
    const auto L = matrix_.topLeftCorner(f, f);
    L.triangularView<Eigen::Lower>().solveInPlace(y_);
    L.transpose().triangularView<Eigen::Upper>().solveInPlace(y_);
  } else {
    y_ = lu_.solve(y_);
  }
  for (Index j = 0; j < f; ++j) {
    const Direction& d = now_.directions[static_cast<std::size_t>(j)];
    const Real y = y_[j] * scale_[j];
    for (std::size_t e = d.first; e < d.end; ++e)
      problem.lambda[now_.entries[e].row] += now_.entries[e].move * y;
  }
  problem.delta = problem.d_free;
  problem.delta.noalias() += problem.W * problem.lambda;

  // Rows that contradict each other have no solution; the regularised one is huge and must not be taken.
  Real left = 0;
  for (Index j = 0; j < f; ++j) {
    const Direction& d = now_.directions[static_cast<std::size_t>(j)];
    Real r = gap_[j];
    for (std::size_t e = d.first; e < d.end; ++e)
      r += now_.entries[e].test * problem.delta[now_.entries[e].row];
    for (int k = 0; k < max_block_dim; ++k) {
      const Index other = j - d.index + k;  // directions of one block are consecutive
      if (other >= 0 && other < f && now_.directions[static_cast<std::size_t>(other)].block == d.block)
        r += now_.compliance[static_cast<std::size_t>(other) * max_block_dim + static_cast<std::size_t>(d.index)] *
             y_[other] * scale_[other];
    }
    left = std::max(left, std::abs(r) * scale_[j]);
  }
  return problem.lambda.allFinite() && left <= 1e-2 * asked;
}

Residual SubspaceStep::newton(ConstraintProblem& problem, const DiagonalBlocks& diagonal,
                              Residual residual, Real tolerance, VecX& lambda_plus,
                              Index& direct_solves) {
  // Modes that have not settled after this many are left to the caller.
  constexpr int steps_in_a_row = 12;
  Residual best = residual;
  Real previous = residual.value;
  best_lambda_ = problem.lambda;
  for (int step = 0; step < steps_in_a_row && residual.value > tolerance; ++step) {
    gather(problem, diagonal, lambda_plus);
    // Same tangents twice: what is left is rounding.
    if (step > 0 && unchanged() && residual.value > 0.5 * previous) break;
    previous = residual.value;
    if (!solve(problem, lambda_plus)) break;
    ++direct_solves;
    residual = natural_map(problem, diagonal, lambda_plus);
    if (!std::isfinite(residual.value)) break;
    if (residual.value < best.value) {
      best = residual;
      best_lambda_ = problem.lambda;
    }
  }
  problem.lambda = best_lambda_;
  update_delta(problem);
  return natural_map(problem, diagonal, lambda_plus);
}

}  // namespace sutura
