#include "solve/idle_blocks.h"

namespace sutura {

IdleBlocks::IdleBlocks(std::size_t bodies) {
  others_.bodies.resize(bodies);
  for (BodyRows& rows : others_.bodies) rows.clear();
}

void IdleBlocks::find(const ConstraintProblem& problem) {
  is_idle_.clear();
  for (const ConstraintBlock& b : problem.blocks)
    is_idle_.push_back(problem.gap[b.first_row] > b.idle_beyond &&
                       problem.lambda.segment(b.first_row, b.law->dim).isZero(0));
}

ConstraintProblem& IdleBlocks::without(const ConstraintProblem& problem) {
  others_.blocks.clear();
  others_.params = problem.params;
  row_.assign(static_cast<std::size_t>(problem.rows()), -1);
  Index rows = 0;
  for (std::size_t i = 0; i < problem.blocks.size(); ++i) {
    if (is_idle_[i]) continue;
    const ConstraintBlock& b = problem.blocks[i];
    others_.blocks.push_back(b);
    others_.blocks.back().first_row = rows;
    for (Index k = 0; k < b.law->dim; ++k) row_[static_cast<std::size_t>(b.first_row + k)] = rows++;
  }
  for (GrowingVec* v : {&others_.gap, &others_.d_free, &others_.lambda, &others_.delta})
    v->resize(rows);
  for (Index i = 0; i < problem.rows(); ++i) {
    const Index to = row_[static_cast<std::size_t>(i)];
    if (to < 0) continue;
    others_.gap[to] = problem.gap[i];
    others_.d_free[to] = problem.d_free[i];
    others_.lambda[to] = problem.lambda[i];
    others_.delta[to] = problem.delta[i];
  }
  for (std::size_t i = 0; i < problem.bodies.size(); ++i)
    gather_rows(problem.bodies[i], others_.bodies[i]);
  return others_;
}

void IdleBlocks::gather_rows(const BodyRows& from, BodyRows& to) const {
  to.clear();
  to.width = from.width;
  for (std::size_t r = 0; r < from.row.size(); ++r) {
    const Index row = row_[static_cast<std::size_t>(from.row[r])];
    if (row < 0) continue;
    const auto first = from.start[r], end = from.start[r + 1], width = Index{from.width};
    to.row.push_back(row);
    to.node.insert(to.node.end(), from.node.begin() + first, from.node.begin() + end);
    to.value.insert(to.value.end(), from.value.begin() + first * width,
                    from.value.begin() + end * width);
    to.start.push_back(static_cast<Index>(to.node.size()));
  }
}

void IdleBlocks::put_back(ConstraintProblem& problem) const {
  std::size_t other = 0;
  for (std::size_t i = 0; i < problem.blocks.size(); ++i) {
    ConstraintBlock& b = problem.blocks[i];
    if (!is_idle_[i]) {
      const ConstraintBlock& solved = others_.blocks[other++];
      b.mode = solved.mode;
      problem.lambda.segment(b.first_row, b.law->dim) =
          others_.lambda.segment(solved.first_row, b.law->dim);
      continue;
    }
    // What its law says of an open gap, whatever the compliance.
    Real W[max_block_dim * max_block_dim] = {}, lambda[max_block_dim] = {};
    for (int k = 0; k < b.law->dim; ++k) W[k * (b.law->dim + 1)] = b.units.length / b.units.force;
    b.law->project({W, problem.gap.data() + b.first_row, problem.block_params(b), &b.mode, lambda});
  }
}

bool IdleBlocks::wake(const ConstraintProblem& problem) {
  bool any = false;
  for (std::size_t i = 0; i < problem.blocks.size(); ++i) {
    if (!is_idle_[i] || problem.d_free[problem.blocks[i].first_row] >= 0) continue;
    is_idle_[i] = 0;
    any = true;
  }
  return any;
}

}  // namespace sutura
