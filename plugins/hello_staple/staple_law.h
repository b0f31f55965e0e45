// Spring between two points, slack below a length, broken above a force: the law of three rows.
//
//   delta   from the second point to the first, in world axes (m)
//   lambda  force on the first point (N)
//
//   slack   |delta| <= L    lambda = 0
//   taut    |delta| > L     lambda = -k (1 - L / |delta|) delta
//   out     for ever        lambda = 0      once |lambda| has reached the pull-out force
#pragma once

#include <Eigen/LU>

#include "sutura/law.h"

struct StapleLaw {
  static constexpr int dim = 3;
  static constexpr const char* name = "staple";
  struct Params {
    sutura::Real stiffness = 1;  ///< k, N/m
    sutura::Real length = 0;     ///< L, m
    sutura::Real pull_out = 1;   ///< N
  };
  static constexpr sutura::Mode slack = 0, taut = 1, out = 2;
  using Vector = sutura::BlockVector<3>;
  using Matrix = sutura::BlockMatrix<3>;

  // Taut, lambda = -s delta with s = k (1 - L / |delta|), so (1 + s W) delta = d. As s grows from 0
  // to k, |delta| falls: there is one s at which both agree, and bisection finds it.
  static void project(const Matrix& W, const Vector& d, const Params& p, sutura::Mode& mode,
                      Vector& lambda) {
    lambda.setZero();
    if (mode == out) return;
    mode = d.norm() > p.length ? taut : slack;
    if (mode == slack) return;
    const auto delta = [&](sutura::Real s) -> Vector {
      return (Matrix::Identity() + s * W).inverse() * d;
    };
    sutura::Real low = 0, high = p.stiffness;
    for (int i = 0; i < 60 && p.length > 0; ++i) {
      const sutura::Real s = (low + high) / 2;
      (s < p.stiffness * (1 - p.length / delta(s).norm()) ? low : high) = s;
    }
    lambda = -high * delta(high);
  }

  // Taut, the spring yields by 1 / k along its line and, turning, by |delta| / |lambda| across it.
  static void free_directions(const Vector& delta, const Params& p, sutura::Mode mode,
                              const Vector& lambda, sutura::FreeDirections<3>& free) {
    free.count = mode == taut && !lambda.isZero(0) ? 3 : 0;
    if (free.count == 0) return;
    const Matrix along = lambda * lambda.transpose() / lambda.squaredNorm();
    const sutura::Real across = delta.norm() / lambda.norm();
    free.compliance = along / p.stiffness + across * (Matrix::Identity() - along);
    free.gap = -delta;
  }

  // Asked only of forces that have been verified at the end of a step.
  static bool event(const Params& p, const Vector&, sutura::Mode& mode, const Vector& lambda) {
    if (mode == out || lambda.norm() < p.pull_out) return false;
    mode = out;
    return true;
  }
};
