// Sweeps of block Gauss-Seidel on an OpenCL device: the kernels of sweep.cl and what they need.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "direct_step.h"
#include "sutura/constraints.h"

namespace sutura::opencl {

/// How many blocks one work-group sweeps faster than many do, as measured on a GPU
/// (docs/theory/opencl.md). What grows with precision is what an item holds in registers.
Index best_in_one_group(Precision precision);

class Sweeps {
 public:
  Sweeps(const Device& device, Precision precision)
      : Sweeps(device, precision, best_in_one_group(precision)) {}
  /// Problems of more blocks than `in_one_group` are swept in panels, by many work-groups.
  Sweeps(const Device& device, Precision precision, Index in_one_group);
  ~Sweeps();

  /// Empty, or why the problem cannot be solved here: a law without twin.
  std::string load(const ConstraintProblem& problem);
  /// One for every blocks.size() entries of `orders`.
  void sweep(ConstraintProblem& problem, std::span<const std::uint32_t> orders);

  /// With double sums only.
  void solve_tangents(const TangentSystem& system, TangentAnswer& answer) {
    direct_.solve(system, raw_.memory(), answer);
  }

  // The parts of `sweep`, for benchmarks: what is sent, what is computed, what comes back.
  void send(const ConstraintProblem& problem, std::span<const std::uint32_t> orders);
  void run(int sweeps);
  void receive(ConstraintProblem& problem);

 private:
  /// For blocks of up to dim_ rows, and for a number of lanes.
  Program& program();

  const Device& device_;
  Precision precision_;
  std::size_t real_, entry_;  ///< bytes
  int in_one_group_;
  int blocks_ = 0, rows_ = 0, dim_ = 1, stride_ = 0;
  std::map<std::pair<int, int>, Program> programs_;
  DirectStep direct_;

  Buffer laws_{device_}, dims_{device_}, first_row_{device_}, first_parameter_{device_},
      orders_{device_}, modes_{device_};
  Numbers raw_{device_, real_}, W_{device_, entry_}, diagonal_{device_, real_},
      inverses_{device_, real_}, parameters_{device_, real_}, changes_{device_, real_},
      state_{device_, real_};
  // What is sent and received stays until the device has answered.
  std::vector<cl_int> host_laws_, host_dims_, host_first_row_, host_first_parameter_;
  std::vector<cl_uchar> host_modes_;
  std::vector<Real> host_parameters_, host_state_;
};

}  // namespace sutura::opencl
