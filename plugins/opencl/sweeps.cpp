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

/// The kernels for blocks of up to `dim` rows and a number of lanes.
struct Sweeps::Program {
  Program(const Device& device, Precision precision, int dim, int lanes)
      : dim(dim),
        lanes(lanes),
        program(device.build(
            definitions(precision) + programs::laws + programs::sweep,
            "-DPARAMETERS=global -DD=" + std::to_string(dim) + " -DLANES=" + std::to_string(lanes) +
                " -DPANEL=" + std::to_string(panel) + " -DSHARE=" + std::to_string(share))),
        pack(device, program, "pack"),
        prepare(device, program, "prepare"),
        in_one_group(device, program, "sweep_in_one_group"),
        in_panels(device, program, "sweep_panel") {}
  ~Program() { clReleaseProgram(program); }
  int dim, lanes;
  cl_program program;
  Kernel pack, prepare, in_one_group, in_panels;
};

Sweeps::Sweeps(const Device& device, Precision precision, Index in_one_group)
    : device_(device),
      precision_(precision),
      in_one_group_(static_cast<int>(
          std::min({in_one_group, Index{1024}, static_cast<Index>(device.largest_group())}))),
      direct_(device, precision),
      raw_(device),
      W_(device),
      diagonal_(device),
      inverses_(device),
      laws_(device),
      dims_(device),
      first_row_(device),
      first_parameter_(device),
      parameters_(device),
      orders_(device),
      changes_(device),
      state_(device),
      modes_(device) {}

Sweeps::~Sweeps() {
  device_.drain();
}

Sweeps::Program& Sweeps::program() {
  const int lanes = blocks_ <= in_one_group_ ? lanes_for(blocks_) : lane_counts[0];
  for (const auto& p : programs_)
    if (p->dim == dim_ && p->lanes == lanes) return *p;
  programs_.push_back(std::make_unique<Program>(device_, precision_, dim_, lanes));
  return *programs_.back();
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
  cl_int parameters = 0;
  for (std::size_t i = 0; i < problem.blocks.size(); ++i) {
    const ConstraintBlock& b = problem.blocks[i];
    const LawTwin& twin = *find_twin(*b.law);
    host_laws_[i] = twin.number;
    host_dims_[i] = b.law->dim;
    host_first_row_[i] = static_cast<cl_int>(b.first_row);
    host_first_parameter_[i] = parameters;
    parameters += twin.parameters();
  }
  laws_.write(host_laws_);
  dims_.write(host_dims_);
  first_row_.write(host_first_row_);
  first_parameter_.write(host_first_parameter_);
  const std::size_t entries = static_cast<std::size_t>(blocks_ * dim_ * dim_) * padded;
  const std::size_t real = has_double_sums(precision_) ? 8 : 4;
  W_.reserve(entries * (stores_double(precision_) ? 8 : 4));
  for (Buffer* b : {&diagonal_, &inverses_})
    b->reserve(static_cast<std::size_t>(dim_ * dim_) * padded * real);
  changes_.reserve(static_cast<std::size_t>(2 * panel * dim_) * real);
  if (has_double_sums(precision_))
    load_numbers<double>(problem);
  else
    load_numbers<float>(problem);
  device_.finish();  // of W: the problem may go before anything is read
  Program& p = program();
  p.pack(padded * static_cast<std::size_t>(blocks_), 64, blocks_, rows_, stride_, first_row_, dims_,
         raw_, W_);
  p.prepare(padded, 64, blocks_, stride_, dims_, laws_, first_parameter_, parameters_, W_,
            diagonal_, inverses_);
  return {};
}

template <class T>
Sweeps::Numbers<T>& Sweeps::numbers() {
  if constexpr (std::is_same_v<T, double>)
    return double_;
  else
    return float_;
}

template <class T>
void Sweeps::load_numbers(const ConstraintProblem& problem) {
  Numbers<T>& host = numbers<T>();
  if constexpr (std::is_same_v<T, double>) {
    raw_.write(problem.W.data(), sizeof(T) * static_cast<std::size_t>(problem.W.size()));
  } else {
    host.W.assign(problem.W.data(), problem.W.data() + problem.W.size());
    raw_.write(host.W);
  }
  host.parameters.clear();
  for (const ConstraintBlock& b : problem.blocks) {
    const LawTwin& twin = *find_twin(*b.law);
    Real values[LawTwin::most_parameters];
    read_parameters(twin, problem.block_params(b), values);
    for (int i = 0; i < twin.parameters(); ++i)
      host.parameters.push_back(static_cast<T>(values[i]));
  }
  parameters_.write(host.parameters);
}

void Sweeps::send(const ConstraintProblem& problem, std::span<const std::uint32_t> orders) {
  orders_.write(orders.data(), orders.size_bytes());
  host_modes_.assign(static_cast<std::size_t>(stride_), 0);
  for (std::size_t i = 0; i < problem.blocks.size(); ++i) host_modes_[i] = problem.blocks[i].mode;
  modes_.write(host_modes_);
  if (has_double_sums(precision_))
    send_numbers<double>(problem);
  else
    send_numbers<float>(problem);
}

template <class T>
void Sweeps::send_numbers(const ConstraintProblem& problem) {
  std::vector<T>& state = numbers<T>().state;
  const auto stride = static_cast<std::size_t>(stride_), dim = static_cast<std::size_t>(dim_);
  state.assign(2 * dim * stride, T(0));
  for (std::size_t i = 0; i < problem.blocks.size(); ++i) {
    const ConstraintBlock& b = problem.blocks[i];
    for (int k = 0; k < b.law->dim; ++k) {
      const std::size_t at = static_cast<std::size_t>(k) * stride + i;
      state[at] = static_cast<T>(problem.lambda[b.first_row + k]);
      state[dim * stride + at] = static_cast<T>(problem.delta[b.first_row + k]);
    }
  }
  state_.write(state);
}

void Sweeps::run(int sweeps) {
  Program& p = program();
  if (blocks_ <= in_one_group_) {
    const auto lanes = static_cast<std::size_t>(p.lanes);
    p.in_one_group(lanes, lanes, blocks_, stride_, sweeps, W_, diagonal_, inverses_, laws_,
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
    p.in_panels(groups * group, group, blocks_, stride_, first, size, before, size_before, parity,
                W_, diagonal_, inverses_, laws_, first_parameter_, parameters_, orders_, changes_,
                state_, modes_);
    if (size == 0) break;
    before = first;
    size_before = size;
    first += size;
    parity = 1 - parity;
  }
}

void Sweeps::receive(ConstraintProblem& problem) {
  if (has_double_sums(precision_))
    receive_numbers<double>(problem);
  else
    receive_numbers<float>(problem);
}

template <class T>
void Sweeps::receive_numbers(ConstraintProblem& problem) {
  // Nothing of the problem is touched before all is here.
  std::vector<T>& state = numbers<T>().state;
  state_.read(state, false);
  modes_.read(host_modes_);
  const auto stride = static_cast<std::size_t>(stride_), dim = static_cast<std::size_t>(dim_);
  for (std::size_t i = 0; i < problem.blocks.size(); ++i) {
    ConstraintBlock& b = problem.blocks[i];
    b.mode = host_modes_[i];
    for (int k = 0; k < b.law->dim; ++k) {
      const std::size_t at = static_cast<std::size_t>(k) * stride + i;
      problem.lambda[b.first_row + k] = state[at];
      problem.delta[b.first_row + k] = state[dim * stride + at];
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
