#include "sweeps.h"

#include <algorithm>

#include "law_twins.h"
#include "programs.h"

namespace sutura::opencl {
namespace {

constexpr int panel = 32, share = 8;
constexpr int lane_counts[] = {64, 128, 320, 640, 1024};  // of the kernel of one group

int lanes_for(int blocks) {
  for (const int lanes : lane_counts)
    if (blocks <= lanes) return lanes;
  return 0;
}

}  // namespace

Index best_in_one_group(Precision precision) {
  switch (precision) {
    case Precision::single:
      return 640;
    case Precision::mixed:
      return 240;
    default:
      return 64;
  }
}

Sweeps::Sweeps(const Device& device, Precision precision, Index in_one_group)
    : device_(device),
      precision_(precision),
      real_(size_of_sum(precision)),
      entry_(size_of_entry(precision)),
      in_one_group_(static_cast<int>(
          std::min({in_one_group, Index{1024}, static_cast<Index>(device.largest_group())}))),
      direct_(device, precision) {}

Sweeps::~Sweeps() {
  device_.drain();
}

Program& Sweeps::program() {
  const int lanes = blocks_ <= in_one_group_ ? lanes_for(blocks_) : lane_counts[0];
  const std::pair key(dim_, lanes);
  return programs_
      .try_emplace(key, device_, precision_, std::string(programs::laws) + programs::sweep,
                   "-DPARAMETERS=global -DD=" + std::to_string(dim_) +
                       " -DLANES=" + std::to_string(lanes) + " -DPANEL=" + std::to_string(panel) +
                       " -DSHARE=" + std::to_string(share))
      .first->second;
}

std::string Sweeps::load(const ConstraintProblem& problem) {
  blocks_ = static_cast<int>(problem.blocks.size());
  rows_ = static_cast<int>(problem.rows());
  dim_ = 1;
  for (const ConstraintBlock& b : problem.blocks) {
    if (find_twin(*b.law) == nullptr)
      return "the law '" + std::string(b.law->name) + "' has no twin on the device";
    dim_ = std::max(dim_, b.law->dim);
  }
  dim_ = dim_ <= 1 ? 1 : dim_ <= 3 ? 3 : 6;
  stride_ = blocks_ <= in_one_group_ ? lanes_for(blocks_) : (blocks_ + 31) / 32 * 32;
  const auto padded = static_cast<std::size_t>(stride_);
  for (auto* v : {&host_laws_, &host_dims_, &host_first_row_, &host_first_parameter_})
    v->assign(padded, 0);
  host_parameters_.clear();
  for (std::size_t i = 0; i < problem.blocks.size(); ++i) {
    const ConstraintBlock& b = problem.blocks[i];
    const LawTwin& twin = *find_twin(*b.law);
    host_laws_[i] = twin.number;
    host_dims_[i] = b.law->dim;
    host_first_row_[i] = static_cast<cl_int>(b.first_row);
    host_first_parameter_[i] = static_cast<cl_int>(host_parameters_.size());
    Real values[LawTwin::most_parameters];
    read_parameters(twin, problem.block_params(b), values);
    host_parameters_.insert(host_parameters_.end(), values, values + twin.parameters());
  }
  laws_.write(host_laws_);
  dims_.write(host_dims_);
  first_row_.write(host_first_row_);
  first_parameter_.write(host_first_parameter_);
  parameters_.write(host_parameters_);
  raw_.write({problem.W.data(), static_cast<std::size_t>(problem.W.size())});
  const auto dim = static_cast<std::size_t>(dim_);
  W_.reserve(static_cast<std::size_t>(blocks_) * dim * dim * padded);
  for (Numbers* n : {&diagonal_, &inverses_}) n->reserve(dim * dim * padded);
  changes_.reserve(2 * panel * dim);
  device_.finish();  // of W: the problem may go before anything is read
  Program& p = program();
  p["pack"](padded * static_cast<std::size_t>(blocks_), 64, blocks_, rows_, stride_, first_row_,
            dims_, raw_, W_);
  p["prepare"](padded, 64, blocks_, stride_, dims_, laws_, first_parameter_, parameters_, W_,
               diagonal_, inverses_);
  return {};
}

void Sweeps::send(const ConstraintProblem& problem, std::span<const std::uint32_t> orders) {
  orders_.write(orders.data(), orders.size_bytes());
  const auto stride = static_cast<std::size_t>(stride_), dim = static_cast<std::size_t>(dim_);
  host_modes_.assign(stride, 0);
  host_state_.assign(2 * dim * stride, 0);
  for (std::size_t i = 0; i < problem.blocks.size(); ++i) {
    const ConstraintBlock& b = problem.blocks[i];
    host_modes_[i] = b.mode;
    for (int k = 0; k < b.law->dim; ++k) {
      const std::size_t at = static_cast<std::size_t>(k) * stride + i;
      host_state_[at] = problem.lambda[b.first_row + k];
      host_state_[dim * stride + at] = problem.delta[b.first_row + k];
    }
  }
  modes_.write(host_modes_);
  state_.write(host_state_);
}

void Sweeps::run(int sweeps) {
  Program& p = program();
  if (blocks_ <= in_one_group_) {
    const auto lanes = static_cast<std::size_t>(stride_);
    p["sweep_in_one_group"](lanes, lanes, blocks_, stride_, sweeps, W_, diagonal_, inverses_, laws_,
                            first_parameter_, parameters_, orders_, state_, modes_);
    return;
  }
  const std::size_t group = panel * share;
  const auto groups = static_cast<std::size_t>(1 + (blocks_ + panel - 1) / panel);
  int before = 0, size_before = 0, parity = 0;
  const int end = sweeps * blocks_;
  for (int first = 0; first <= end;) {
    // A panel lies within one sweep. The last launch only applies what the last panel has changed.
    const int size = std::min({panel, blocks_ - first % blocks_, end - first});
    p["sweep_panel"](groups * group, group, blocks_, stride_, first, size, before, size_before,
                     parity, W_, diagonal_, inverses_, laws_, first_parameter_, parameters_,
                     orders_, changes_, state_, modes_);
    if (size == 0) break;
    before = first;
    size_before = size;
    first += size;
    parity = 1 - parity;
  }
}

void Sweeps::receive(ConstraintProblem& problem) {
  // Nothing of the problem is touched before all is here.
  modes_.read(host_modes_, false);
  state_.read(host_state_);
  const auto stride = static_cast<std::size_t>(stride_), dim = static_cast<std::size_t>(dim_);
  for (std::size_t i = 0; i < problem.blocks.size(); ++i) {
    ConstraintBlock& b = problem.blocks[i];
    b.mode = host_modes_[i];
    for (int k = 0; k < b.law->dim; ++k) {
      const std::size_t at = static_cast<std::size_t>(k) * stride + i;
      problem.lambda[b.first_row + k] = host_state_[at];
      problem.delta[b.first_row + k] = host_state_[dim * stride + at];
    }
  }
}

void Sweeps::sweep(ConstraintProblem& problem, std::span<const std::uint32_t> orders) {
  if (blocks_ == 0) return;
  send(problem, orders);
  run(static_cast<int>(orders.size()) / blocks_);
  receive(problem);
}

}  // namespace sutura::opencl
