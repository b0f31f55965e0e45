#include "direct_step.h"

#include "programs.h"

namespace sutura::opencl {
namespace {

constexpr std::size_t items = 256;
constexpr Index tile = 32;  // as in direct_step.cl

}  // namespace

DirectStep::DirectStep(const Device& device, Precision precision)
    : program_(device, precision, programs::direct_step, "-DMOST=" + std::to_string(max_block_dim)),
      integers_(device),
      reals_(device),
      delta_(device),
      system_{Buffer(device), Buffer(device)},
      answer_(device) {}

void DirectStep::solve(const TangentSystem& s, const Buffer& W, TangentAnswer& answer) {
  host_integers_.clear();
  host_reals_.clear();
  for (const auto& part : {s.first, s.first_of_block, s.row})
    host_integers_.insert(host_integers_.end(), part.begin(), part.end());
  for (const auto& part : {s.scale, s.gap, s.compliance, s.base, s.d_free, s.move, s.test})
    host_reals_.insert(host_reals_.end(), part.begin(), part.end());
  integers_.write(host_integers_);
  reals_.write(host_reals_);

  const std::size_t count = s.scale.size(), rows = s.base.size(), tiles = (count + tile - 1) / tile,
                    numbers = tiles * (tiles + 1) * tile * tile;
  for (Buffer& b : system_) b.reserve(numbers * sizeof(Real));
  delta_.reserve(rows * sizeof(Real));
  answer_.reserve((2 * count + rows) * sizeof(Real));
  const auto f = static_cast<cl_int>(count), n = static_cast<cl_int>(rows),
             t = static_cast<cl_int>(tiles);
  program_["direct_start"](8 * rows, items, f, n, integers_, reals_, W, delta_);
  program_["direct_system"](numbers, items, f, n, t, s.regularisation, integers_, reals_, W, delta_,
                            answer_, system_[0]);
  for (cl_int k = 0; k < t; ++k)
    program_["direct_eliminate"](static_cast<std::size_t>(t * (t - k)) * items, items, k, t,
                                 system_[k & 1], system_[(k & 1) ^ 1]);
  program_["direct_answer"](8 * rows, items, f, n, t, integers_, reals_, W, system_[t & 1], delta_,
                            answer_);
  answer.numbers.resize(2 * count + rows);
  answer_.read(answer.numbers);
}

}  // namespace sutura::opencl
