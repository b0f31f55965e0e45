// Constraint problems made in test code, without bodies: blocks, W and d_free directly.
#pragma once

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "../plugins/suturing/path_friction_law.h"
#include "sutura/constraints.h"
#include "sutura/laws/bilateral.h"

namespace sutura::test {

/// Appends a block; W and d_free are set by the caller once all blocks are there.
template <Law L>
void append(ConstraintProblem& p, const typename L::Params& params, Mode mode = 0,
            BlockUnits units = {}) {
  ConstraintBlock b;
  b.law = &law_operations<L>;
  b.first_row = p.blocks.empty() ? 0 : p.blocks.back().first_row + p.blocks.back().law->dim;
  b.key = make_key(1, p.blocks.size());
  b.units = units;
  b.mode = mode;
  const std::size_t slot = sizeof(std::max_align_t), at = p.params.size();
  b.params = at * slot;
  p.params.resize(at + (sizeof(params) + slot - 1) / slot);
  std::memcpy(p.params.data() + at, &params, sizeof(params));
  p.blocks.push_back(b);
}

inline void finish(ConstraintProblem& p, const MatX& W, const VecX& d_free) {
  p.W = W;
  p.gap = p.d_free = d_free;
  p.lambda.setZero(d_free.size());
  p.delta.setZero(d_free.size());
}

template <int N>
BlockMatrix<N> random_spd(std::mt19937_64& random) {
  std::normal_distribution<Real> normal;
  std::uniform_real_distribution<Real> exponent(-2, 1);
  BlockMatrix<N> B;
  for (int i = 0; i < N * N; ++i) B.data()[i] = normal(random);
  return B * B.transpose() + std::pow(10, exponent(random)) * BlockMatrix<N>::Identity();
}

struct StitchOptions {
  int samples = 50;
  Real dt = 0.01;
  Real pull = 0.2;           ///< N, along the thread at its end
  Real pull_back = 0;        ///< N, against it at the other end
  Real lateral = 0.05;       ///< N, across at its end
  Real static_level = 0.01;  ///< N per sample
  Real kinetic = 0.008;      ///< N per sample
  Real viscous = 0;          ///< N/m per sample
  std::uint64_t seed = 1;
};

/// A free thread (polypropylene 4-0 like: 2e-5 kg/m, axial and bending springs, 1 mm beams) through
/// a path in tissue: two lateral bilateral rows and one friction row per sample. The thread as a
/// whole is almost free: W has a few modes of tens to thousands of m/N, against 0.01 m/N of the
/// tissue.
inline ConstraintProblem stitch(const StitchOptions& o) {
  const int nodes = o.samples + 60;
  const Real spacing = 1e-3, h = o.dt;
  const Real axial = 30 / spacing;                            // EA / L, N/m
  const Real bending = 7e-8 / (spacing * spacing * spacing);  // EI / L^3, N/m
  MatX A[2];                                                  // axial, one lateral
  for (MatX& a : A) a = 2e-5 * spacing * MatX::Identity(nodes, nodes);
  for (int i = 0; i + 1 < nodes; ++i) {
    VecX g = VecX::Zero(nodes);
    g[i] = -1, g[i + 1] = 1;
    A[0] += h * h * axial * g * g.transpose();
    if (i == 0) continue;
    VecX c = VecX::Zero(nodes);
    c[i - 1] = 1, c[i] = -2, c[i + 1] = 1;
    A[1] += h * h * bending * c * c.transpose();
  }
  const MatX inverse[2] = {A[0].inverse(), A[1].inverse()};

  std::mt19937_64 random(o.seed);
  std::uniform_real_distribution<Real> some(0.5, 1.5);
  ConstraintProblem p;
  const int first = 20;  // node at the first sample
  for (int i = 0; i < o.samples; ++i) {
    append<Bilateral<2>>(p, {});
    const Real share = some(random);
    append<suturing::PathFrictionLaw>(p,
                                      {.static_level = o.static_level * share,
                                       .kinetic = o.kinetic * share,
                                       .viscous = o.viscous,
                                       .stick_slip = 1e-4 * h},
                                      suturing::PathFrictionLaw::stick, {.force = 0.01});
  }
  const int n = 3 * o.samples;
  MatX W(n, n);
  VecX d(n);
  for (int i = 0; i < o.samples; ++i) {
    for (int j = 0; j < o.samples; ++j) {
      W.block<3, 3>(3 * i, 3 * j).setZero();
      const Real tissue = 0.01 * std::exp(-std::abs(i - j) / 5.0);  // m/N
      for (int k = 0; k < 3; ++k)
        W(3 * i + k, 3 * j + k) = tissue + h * h * inverse[k == 2 ? 0 : 1](first + i, first + j);
    }
    const Real reach = h * h * inverse[1](first + i, nodes - 1);
    d[3 * i] = reach * o.lateral + 1e-4 * (some(random) - 1);
    d[3 * i + 1] = -0.3 * reach * o.lateral + 1e-4 * (some(random) - 1);
    d[3 * i + 2] =
        h * h *
        (inverse[0](first + i, nodes - 1) * o.pull - inverse[0](first + i, 0) * o.pull_back);
  }
  finish(p, 0.5 * (W + W.transpose()), d);
  return p;
}

}  // namespace sutura::test
