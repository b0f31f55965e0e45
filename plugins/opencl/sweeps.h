// Sweeps of block Gauss-Seidel on an OpenCL device: the kernels of sweep.cl and what they need.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "device.h"
#include "direct_step.h"
#include "precision.h"
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
    direct_.solve(system, raw_, answer);
  }

  // The parts of `sweep`, for benchmarks: what is sent, what is computed, what comes back.
  void send(const ConstraintProblem& problem, std::span<const std::uint32_t> orders);
  void run(int sweeps);
  void receive(ConstraintProblem& problem);

 private:
  struct Program;
  Program& program();
  /// What is sent and received as numbers of the precision of sums; it has to stay until the
  /// device has answered.
  template <class T>
  struct Numbers {
    std::vector<T> W, parameters, state;
  };
  template <class T>
  Numbers<T>& numbers();
  template <class T>
  void load_numbers(const ConstraintProblem& problem);
  template <class T>
  void send_numbers(const ConstraintProblem& problem);
  template <class T>
  void receive_numbers(ConstraintProblem& problem);

  const Device& device_;
  Precision precision_;
  int in_one_group_;
  int blocks_ = 0, rows_ = 0, dim_ = 1, stride_ = 0;
  std::vector<std::unique_ptr<Program>> programs_;
  DirectStep direct_;

  Buffer raw_, W_, diagonal_, inverses_, laws_, dims_, first_row_, first_parameter_, parameters_,
      orders_, changes_, state_, modes_;
  std::vector<cl_int> host_laws_, host_dims_, host_first_row_, host_first_parameter_;
  std::vector<cl_uchar> host_modes_;
  Numbers<double> double_;
  Numbers<float> float_;
};

}  // namespace sutura::opencl
