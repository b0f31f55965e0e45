// Constraint problems on random chains: H and the condensed inverse made here from a dense one, so
// that the operator can be held against W = H A^-1 H^T.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <random>
#include <set>

#include "solve_problems.h"

namespace sutura::test {

/// A^-1 of a block tridiagonal matrix, random or of beams that hang loosely together.
inline MatX random_chain_inverse(Index nodes, std::mt19937_64& random) {
  std::normal_distribution<Real> normal;
  MatX A = MatX::Zero(6 * nodes, 6 * nodes);
  for (Index i = 0; i < nodes; ++i) A.block<6, 6>(6 * i, 6 * i) += 0.1 * random_spd<6>(random);
  for (Index i = 0; i + 1 < nodes; ++i) {
    Eigen::Matrix<Real, 6, 12> B;
    for (Real& x : B.reshaped()) x = normal(random);
    A.block<12, 12>(6 * i, 6 * i) += B.transpose() * B;
  }
  return A.llt().solve(MatX::Identity(6 * nodes, 6 * nodes));
}

struct ChainRows {
  std::vector<std::vector<Index>> nodes;  ///< per block
  std::set<Index> clamped;
};

/// Blocks of three rows with random coefficients on the given nodes; the chain is body 0. Dense:
/// what W should be.
struct ChainProblem {
  ConstraintProblem problem;
  MatX W;
};

template <Law L = Bilateral<3>>
ChainProblem chain_problem(Index nodes, const ChainRows& rows, std::mt19937_64& random,
                           const typename L::Params& params = {}) {
  std::normal_distribution<Real> normal;
  ChainProblem out;
  ConstraintProblem& p = out.problem;
  p.bodies.resize(1);
  p.chains.resize(1);
  BodyRows& H = p.bodies[0];
  H.clear();
  H.width = 6;
  std::set<Index> touched;
  for (const std::vector<Index>& block : rows.nodes) {
    append<L>(p, params);
    for (int k = 0; k < L::dim && !block.empty(); ++k) {
      H.row.push_back(p.blocks.back().first_row + k);
      for (const Index node : block) {
        if (!rows.clamped.contains(node)) touched.insert(node);
        H.node.push_back(node);
        for (int c = 0; c < 6; ++c) H.value.push_back(normal(random));
      }
      H.start.push_back(static_cast<Index>(H.node.size()));
    }
  }
  const Index n = static_cast<Index>(rows.nodes.size()) * L::dim;
  const MatX G = random_chain_inverse(nodes, random);
  MatX dense = MatX::Zero(n, 6 * nodes);
  for (std::size_t i = 0; i < H.row.size(); ++i)
    for (Index e = H.start[i]; e < H.start[i + 1]; ++e) {
      const Index node = H.node[static_cast<std::size_t>(e)];
      if (rows.clamped.contains(node)) continue;
      for (int c = 0; c < 6; ++c)
        dense(H.row[i], 6 * node + c) += H.value[static_cast<std::size_t>(6 * e + c)];
    }
  out.W = dense * G * dense.transpose();

  ChainCompliance& chain = p.chains[0];
  chain.node.assign(touched.begin(), touched.end());
  for (std::size_t a = 0; a < chain.node.size(); ++a) {
    const Index i = 6 * chain.node[a];
    chain.own.push_back(G.block<6, 6>(i, i));
    chain.transfer.push_back(Mat6::Zero());
    if (a + 1 == chain.node.size()) continue;
    const Index j = 6 * chain.node[a + 1];
    chain.transfer[a] = G.block<6, 6>(i, j) * G.block<6, 6>(j, j).inverse();
  }
  finish(p, MatX(0, 0), VecX::Zero(n));
  return out;
}

}  // namespace sutura::test
