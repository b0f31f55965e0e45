// The part of the direct step that a device does: what it is sent, and what is made of its answer.
#include <algorithm>
#include <cmath>

#include "solve/subspace_step.h"

namespace sutura {

/// As `factorise` makes them of the whole matrix.
void SubspaceStep::find_scales(const ConstraintProblem& problem) {
  const auto f = static_cast<Index>(now_.directions.size());
  scale_.resize(f);
  for (Index j = 0; j < f; ++j) {
    const Direction& d = now_.directions[static_cast<std::size_t>(j)];
    Real g = now_.compliance[static_cast<std::size_t>(j) * max_block_dim +
                             static_cast<std::size_t>(d.index)];
    for (std::size_t a = d.first; a < d.end; ++a)
      for (std::size_t b = d.first; b < d.end; ++b)
        g += now_.entries[a].test * problem.W(now_.entries[a].row, now_.entries[b].row) *
             now_.entries[b].move;
    scale_[j] = g != 0 ? 1 / std::sqrt(std::abs(g)) : Real(1);
  }
}

bool SubspaceStep::solve_on_device(ConstraintProblem& problem) {
  const std::size_t f = now_.directions.size();
  find_scales(problem);
  Sent& s = sent_;
  for (auto* v : {&s.first, &s.row, &s.first_of_block}) v->clear();
  for (auto* v : {&s.move, &s.test}) v->clear();
  for (std::size_t j = 0; j < f; ++j) {
    const Direction& d = now_.directions[j];
    s.first.push_back(static_cast<std::int32_t>(d.first));
    s.first_of_block.push_back(static_cast<std::int32_t>(j) - d.index);
  }
  s.first.push_back(static_cast<std::int32_t>(now_.entries.size()));
  for (const Entry& e : now_.entries) {
    s.row.push_back(static_cast<std::int32_t>(e.row));
    s.move.push_back(e.move);
    s.test.push_back(e.test);
  }
  // The device scales all of the diagonal, so damping goes in as a compliance of the row.
  s.compliance = now_.compliance;
  for (std::size_t j = 0; j < f; ++j) {
    const auto row = static_cast<Index>(j);
    const Real damped = damping_of(problem, row) - undamped;
    s.compliance[j * max_block_dim + static_cast<std::size_t>(now_.directions[j].index)] +=
        damped / (scale_[row] * scale_[row]);
  }
  const auto all = [](const GrowingVec& v) {
    return std::span<const Real>(v.data(), static_cast<std::size_t>(v.size()));
  };
  TangentAnswer& answer = s.answer;
  if (!device_->solve_tangents(
          {s.first, s.first_of_block, s.row, all(scale_), all(gap_).first(f), s.compliance,
           all(base_), all(problem.d_free), s.move, s.test, undamped},
          answer)) {
    device_ = nullptr;
    return false;
  }
  const auto y = answer.y(f), right = answer.right(f), delta = answer.delta(f);
  y_.resize(static_cast<Index>(f));
  std::copy(y.begin(), y.end(), y_.begin());
  asked_of_system_ = 0;
  for (const Real r : right) asked_of_system_ = std::max(asked_of_system_, std::abs(r));
  apply(problem);
  std::copy(delta.begin(), delta.end(), problem.delta.begin());
  return true;
}

}  // namespace sutura
