// What sources append, made into the arrays of one step's problem. All buffers keep their capacity,
// so that a step allocates nothing once the largest problem has been seen.
#include <algorithm>
#include <cassert>

#include "sutura/archive.h"
#include "sutura/constraints.h"

namespace sutura {

ConstraintBuilder::ConstraintBuilder(ConstraintProblem& problem, std::vector<const Body*> bodies)
    : problem_(problem), bodies_(std::move(bodies)) {
  problem_.bodies.resize(bodies_.size());
  for (BodyRows& rows : problem_.bodies) rows.clear();
}

namespace {

/// In which a block begins the next step.
Mode next_mode(const ConstraintProblem& problem, const ConstraintBlock& b) {
  if (b.law->next_mode == nullptr) return b.mode;
  return b.law->next_mode(problem.block_params(b), problem.delta.data() + b.first_row, b.mode,
                          problem.lambda.data() + b.first_row);
}

}  // namespace

void ConstraintBuilder::Memory::remember(const ConstraintProblem& problem, Warm next) {
  blocks.clear();
  for (const ConstraintBlock& b : problem.blocks)
    blocks.push_back({b.key, b.law->name, b.first_row,
                      next == Warm::step_before ? next_mode(problem, b) : b.mode});
  std::sort(blocks.begin(), blocks.end(),
            [](const Known& a, const Known& b) { return a.key < b.key; });
  lambda.assign(problem.lambda.begin(), problem.lambda.end());
}

const ConstraintBuilder::Known* ConstraintBuilder::Memory::find(Key wanted) const {
  const auto it =
      std::lower_bound(blocks.begin(), blocks.end(), wanted,
                       [](const Known& known, const Key& key) { return known.key < key; });
  return it != blocks.end() && it->key == wanted ? &*it : nullptr;
}

const ConstraintBuilder::Memory& ConstraintBuilder::memory() const {
  switch (warm_) {
    case Warm::pass_before:
      return pass_before_;
    case Warm::best_guess:
      return best_guess_;
    case Warm::step_before:
      break;
  }
  return step_before_;
}

Real ConstraintBuilder::known_force(Key key, Index row) const {
  const Known* known = memory().find(key);
  return known != nullptr ? memory().lambda[static_cast<std::size_t>(known->first + row)] : Real(0);
}

Mode ConstraintBuilder::known_mode(Key key, Mode otherwise) const {
  const Known* known = memory().find(key);
  return known != nullptr ? known->mode : otherwise;
}

void ConstraintBuilder::mark_redundant(BlockId block) {
  assert(block.valid());
  problem_.blocks[static_cast<std::size_t>(block.index)].redundant = true;
}

void ConstraintBuilder::may_idle(BlockId block, Real beyond) {
  assert(block.valid());
  problem_.blocks[static_cast<std::size_t>(block.index)].idle_beyond = beyond;
}

void ConstraintBuilder::keep_within(BlockId block, Real precision) {
  assert(block.valid());
  problem_.blocks[static_cast<std::size_t>(block.index)].precision = precision;
}

void ConstraintBuilder::time_event(BlockId block) {
  assert(block.valid());
  problem_.blocks[static_cast<std::size_t>(block.index)].timed = true;
}

void ConstraintBuilder::accept() {
  step_before_.remember(problem_, Warm::step_before);
}

void ConstraintBuilder::mark_best_guess() {
  best_guess_.remember(problem_, Warm::best_guess);
}

void ConstraintBuilder::begin(Warm warm) {
  warm_ = warm;
  if (warm == Warm::pass_before) pass_before_.remember(problem_, Warm::pass_before);
  problem_.blocks.clear();
  problem_.params.clear();
  patches_.clear();
  patch_nodes_.clear();
  patch_values_.clear();
  first_patch_.clear();
  last_patch_.clear();
  gap_.clear();
  first_lambda_.clear();
}

BlockId ConstraintBuilder::add_block(const LawOperations* law, Key key, const void* params,
                                     const Real* gap, Mode mode, BlockUnits units) {
  ConstraintBlock block;
  block.law = law;
  block.first_row = static_cast<Index>(gap_.size());
  block.key = key;
  block.units = units;
  block.mode = mode;

  constexpr std::size_t slot = sizeof(std::max_align_t);
  const std::size_t at = problem_.params.size();
  block.params = at * slot;
  problem_.params.resize(at + (law->params_size + slot - 1) / slot);
  std::memcpy(problem_.params.data() + at, params, law->params_size);

  gap_.insert(gap_.end(), gap, gap + law->dim);
  first_lambda_.resize(gap_.size(), 0);
  problem_.blocks.push_back(block);
  first_patch_.push_back(-1);
  last_patch_.push_back(-1);
  return {static_cast<Index>(problem_.blocks.size()) - 1};
}

void ConstraintBuilder::couple(BlockId id, const Body& body, const Directions& directions,
                               const PointJacobian& J, const Vec3& at) {
  assert(id.valid() && id.index < static_cast<Index>(problem_.blocks.size()));
  ConstraintBlock& block = problem_.blocks[static_cast<std::size_t>(id.index)];
  const int dim = block.law->dim;
  assert(directions.rows() == dim && J.width == body.width());
  const auto found = std::find(bodies_.begin(), bodies_.end(), &body);
  assert(found != bodies_.end());

  Patch patch;
  patch.block = id.index;
  patch.next = -1;
  patch.body = static_cast<std::size_t>(found - bodies_.begin());
  patch.nodes = J.nodes;
  patch.first_node = patch_nodes_.size();
  patch.first_value = patch_values_.size();
  patch_nodes_.insert(patch_nodes_.end(), J.node.begin(), J.node.begin() + J.nodes);
  const Index columns = static_cast<Index>(J.nodes) * J.width;
  patch_values_.resize(patch_values_.size() + static_cast<std::size_t>(dim * columns));
  Eigen::Map<MatX>(patch_values_.data() + patch.first_value, dim, columns) =
      directions.lazyProduct(J.coefficients.leftCols(columns));

  const auto n = static_cast<Index>(patches_.size());
  const auto b = static_cast<std::size_t>(id.index);
  if (first_patch_[b] < 0) {
    first_patch_[b] = n;
    block.at = at;
    block.axes.leftCols(dim) = directions.transpose();
  } else {
    patches_[static_cast<std::size_t>(last_patch_[b])].next = n;
  }
  last_patch_[b] = n;
  patches_.push_back(patch);
}

void ConstraintBuilder::gather_rows(std::size_t body) {
  BodyRows& rows = problem_.bodies[body];
  rows.clear();
  rows.width = bodies_[body]->width();
  const auto width = static_cast<std::size_t>(rows.width);
  for (std::size_t b = 0; b < problem_.blocks.size(); ++b) {
    const ConstraintBlock& block = problem_.blocks[b];
    const auto dim = static_cast<std::size_t>(block.law->dim);
    merged_nodes_.clear();
    merged_values_.clear();  // per node: dim x width, column major
    for (Index i = first_patch_[b]; i >= 0; i = patches_[static_cast<std::size_t>(i)].next) {
      const Patch& patch = patches_[static_cast<std::size_t>(i)];
      if (patch.body != body) continue;
      for (int k = 0; k < patch.nodes; ++k) {
        const Index node = patch_nodes_[patch.first_node + static_cast<std::size_t>(k)];
        const auto found = std::find(merged_nodes_.begin(), merged_nodes_.end(), node);
        const auto slot = static_cast<std::size_t>(found - merged_nodes_.begin());
        if (found == merged_nodes_.end()) {
          merged_nodes_.push_back(node);
          merged_values_.resize(merged_values_.size() + dim * width, Real(0));
        }
        const Real* from =
            &patch_values_[patch.first_value + static_cast<std::size_t>(k) * width * dim];
        Real* to = &merged_values_[slot * width * dim];
        for (std::size_t j = 0; j < dim * width; ++j) to[j] += from[j];
      }
    }
    if (merged_nodes_.empty()) continue;
    for (std::size_t r = 0; r < dim; ++r) {
      rows.row.push_back(block.first_row + static_cast<Index>(r));
      for (std::size_t k = 0; k < merged_nodes_.size(); ++k) {
        rows.node.push_back(merged_nodes_[k]);
        for (std::size_t j = 0; j < width; ++j)
          rows.value.push_back(merged_values_[(k * width + j) * dim + r]);
      }
      rows.start.push_back(static_cast<Index>(rows.node.size()));
    }
  }
}

void ConstraintBuilder::finish() {
  const auto rows = static_cast<Index>(gap_.size());
  problem_.gap = Eigen::Map<const VecX>(gap_.data(), rows);
  problem_.d_free = problem_.gap;
  problem_.delta = problem_.gap;
  problem_.lambda = Eigen::Map<const VecX>(first_lambda_.data(), rows);
  const Memory& memory = this->memory();
  for (ConstraintBlock& b : problem_.blocks) {
    const Known* old = memory.find(b.key);
    if (old == nullptr || old->law != b.law->name) continue;
    const Eigen::Map<const VecX> lambda(memory.lambda.data() + old->first, b.law->dim);
    if (lambda.allFinite()) problem_.lambda.segment(b.first_row, b.law->dim) = lambda;
    b.mode = old->mode;
  }
  for (std::size_t body = 0; body < bodies_.size(); ++body) gather_rows(body);
}

void ConstraintBuilder::Memory::archive(Archive& a, std::set<std::string>& laws) {
  a.list("blocks", blocks, [&laws](Archive& each, Known& known) {
    std::string law(known.law);
    each("key", known.key.value);
    each("law", law);
    each("first", known.first);
    each("mode", known.mode);
    if (each.restoring()) known.law = *laws.insert(law).first;
  });
  a("lambda", lambda);
}

void ConstraintBuilder::archive(Archive& a) {
  step_before_.archive(a, restored_laws_);
}

}  // namespace sutura
