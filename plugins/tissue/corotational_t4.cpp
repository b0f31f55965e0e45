#include "corotational_t4.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "strain.h"
#include "twist_stiffness.h"

namespace sutura::tissue {
CorotationalT4::CorotationalT4(const std::vector<Vec3>& rest, const std::vector<Tet>& tets) {
  sorted_.reserve(tets.size());
  for (Tet t : tets) {
    std::sort(t.begin(), t.end());
    sorted_.push_back(t);
  }
  packs_.resize((tets.size() + lanes - 1) / lanes);
  for (std::size_t e = 0; e < packs_.size() * lanes; ++e) {
    Pack& p = packs_[e / lanes];
    const int k = static_cast<int>(e % lanes);
    const Tet& t = sorted_[std::min(e, sorted_.size() - 1)];
    const Mat3 D = tet_edges(t, rest);
    const Mat3 inverse = D.inverse();  // its rows are the gradients of the shape functions
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < 3; ++i) p.gradient[c][i][k] = inverse(c, i);
    p.volume[k] = e < sorted_.size() ? std::abs(D.determinant()) / 6 : 0;
    p.mu[k] = p.lambda[k] = 0;
    for (int c = 0; c < 4; ++c) p.node[c][k] = static_cast<std::int32_t>(t[c]);
  }
}

std::vector<std::array<Index, 2>> CorotationalT4::pairs() const {
  std::vector<Index> flat;
  flat.reserve(4 * sorted_.size());
  for (const Tet& t : sorted_) flat.insert(flat.end(), t.begin(), t.end());
  return pairs_of_elements(flat, 4);
}

void CorotationalT4::bind(const NodePattern& pattern) {
  ++revision_;
  for (Pack& p : packs_)
    for (int k = 0; k < lanes; ++k) {
      int s = 0;
      for (int a = 0; a < 4; ++a)
        for (int b = a; b < 4; ++b) {
          const Index slot = pattern.slot(p.node[a][k], p.node[b][k]);
          assert(slot >= 0);
          p.slot[s++][k] = static_cast<std::int32_t>(slot);
        }
    }
}

void CorotationalT4::set_materials(const std::vector<Material>& per_tet) {
  assert(per_tet.size() == sorted_.size());
  ++revision_;
  for (std::size_t e = 0; e < per_tet.size(); ++e) {
    Pack& p = packs_[e / lanes];
    const int k = static_cast<int>(e % lanes);
    p.mu[k] = per_tet[e].lame_mu() * p.volume[k];
    p.lambda[k] = per_tet[e].lame_lambda() * p.volume[k];
  }
}

bool CorotationalT4::tets(TetElementsView& view, Index& revision) {
  Listed& l = listed_;
  if (listed_revision_ != revision_) {
    l = {};
    for (std::size_t e = 0; e < sorted_.size(); ++e) {
      const Pack& p = packs_[e / lanes];
      const int k = static_cast<int>(e % lanes);
      for (int c = 0; c < 4; ++c) l.node.push_back(p.node[c][k]);
      for (int s = 0; s < 10; ++s) l.slot.push_back(p.slot[s][k]);
      for (int c = 0; c < 3; ++c)
        for (int i = 0; i < 3; ++i) l.gradient.push_back(p.gradient[c][i][k]);
      l.volume.push_back(p.volume[k]);
      l.moduli.push_back(p.mu[k]);
      l.moduli.push_back(p.lambda[k]);
    }
    listed_revision_ = revision_;
  }
  view = {l.node, l.slot, l.gradient, l.volume, l.moduli};
  revision = revision_;
  return true;
}

void CorotationalT4::deformation_gradient(const Pack& p, const VecX& x, Small3<Lanes>& F) const {
  Lanes X[4][3];
  for (int c = 0; c < 4; ++c)
    for (int k = 0; k < lanes; ++k) {
      const Real* at = x.data() + 3 * static_cast<Index>(p.node[c][k]);
      for (int i = 0; i < 3; ++i) X[c][i][k] = at[i];
    }
  for (int i = 0; i < 3; ++i) {
    const Lanes d1 = X[1][i] - X[0][i], d2 = X[2][i] - X[0][i], d3 = X[3][i] - X[0][i];
    for (int j = 0; j < 3; ++j)
      F[3 * j + i] = d1 * p.gradient[0][j] + d2 * p.gradient[1][j] + d3 * p.gradient[2][j];
  }
}

/// Rotation, strain and turned gradients of a pack; takes its force into `force`.
void CorotationalT4::stress(const Pack& p, const VecX& x, Stressed& s, VecX& force) const {
  Small3<Lanes> F;
  deformation_gradient(p, x, F);
  const Small3<Lanes>& R = s.R;
  rotations(F, s.R);
  biot_strain(F, R, s.E);
  const Real stiffer = add_viscosity(viscous_share_, p.start, s.E);
  const Lanes(&E)[6] = s.E;

  // First Piola-Kirchhoff stress times volume: P = R (2 mu E + lambda tr E I).
  const Lanes pressure = stiffer * p.lambda * (E[0] + E[1] + E[2]);
  const Lanes two_mu = 2.0 * stiffer * p.mu;
  const Lanes T[9] = {two_mu * E[0] + pressure, two_mu * E[3], two_mu * E[4], two_mu * E[3],
                      two_mu * E[1] + pressure, two_mu * E[5], two_mu * E[4], two_mu * E[5],
                      two_mu * E[2] + pressure};
  Lanes t[4][3];  // forces, t = R T G
  for (int i = 0; i < 3; ++i) s.g[0][i] = t[0][i] = Lanes{};
  for (int c = 1; c < 4; ++c) {
    const Lanes* G = p.gradient[c - 1];
    Lanes TG[3];
    for (int i = 0; i < 3; ++i) TG[i] = T[3 * i] * G[0] + T[3 * i + 1] * G[1] + T[3 * i + 2] * G[2];
    for (int i = 0; i < 3; ++i) {
      s.g[c][i] = R[i] * G[0] + R[3 + i] * G[1] + R[6 + i] * G[2];
      t[c][i] = R[i] * TG[0] + R[3 + i] * TG[1] + R[6 + i] * TG[2];
      s.g[0][i] -= s.g[c][i];
      t[0][i] -= t[c][i];
    }
  }
  for (int c = 0; c < 4; ++c)
    for (int k = 0; k < lanes; ++k) {
      Real* at = force.data() + 3 * static_cast<Index>(p.node[c][k]);
      for (int i = 0; i < 3; ++i) at[i] -= t[c][i][k];
    }
}

void CorotationalT4::add_force(const VecX& x, VecX& force) const {
  Stressed s;
  for (const Pack& p : packs_) stress(p, x, s, force);
}

void CorotationalT4::linearise(const VecX& x, Real scale, NodeMatrix& A, VecX& force) {
  Real* const values = A.values();
  Stressed s;
  for (const Pack& p : packs_) {
    stress(p, x, s, force);
    const auto& g = s.g;
    Lanes twist[6];
    twist_stiffness(s.E, p.mu, p.lambda, twist);
    turn_symmetric(s.R.data(), twist);
    for (Lanes& t : twist) t *= 0.5 * scale;

    // K_ab = V (lambda g_a g_b^T + mu g_b g_a^T + mu g_a . g_b I), and twist
    const Lanes mu = scale * p.mu, lambda = scale * p.lambda;
    int pair = 0;
    for (int a = 0; a < 4; ++a)
      for (int b = a; b < 4; ++b, ++pair) {
        Lanes K[9];
        const Lanes shear = mu * (g[a][0] * g[b][0] + g[a][1] * g[b][1] + g[a][2] * g[b][2]);
        if (a == b) {  // symmetric to the last bit
          for (int i = 0; i < 3; ++i)
            for (int j = i; j < 3; ++j)
              K[3 * i + j] = K[3 * j + i] = (lambda + mu) * g[a][i] * g[a][j];
        } else {
          for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
              K[3 * i + j] = lambda * g[a][i] * g[b][j] + mu * g[b][i] * g[a][j];
        }
        for (int i = 0; i < 3; ++i) K[4 * i] += shear;
        add_twist(twist, g[a], g[b], K);
        for (int k = 0; k < lanes; ++k) {
          Real* block = values + 9 * static_cast<Index>(p.slot[pair][k]);
          for (int i = 0; i < 9; ++i) block[i] += K[i][k];
        }
      }
  }
}

void CorotationalT4::set_viscosity(const VecX& start, Real share) {
  viscous_share_ = share;
  if (share == 0) return;
  for (Pack& p : packs_) {
    Small3<Lanes> F, R;
    deformation_gradient(p, start, F);
    rotations(F, R);
    biot_strain(F, R, p.start);
  }
}

Real CorotationalT4::energy(const VecX& x) const {
  Lanes sum{};
  for (const Pack& p : packs_) {
    Small3<Lanes> F, R;
    deformation_gradient(p, x, F);
    rotations(F, R);
    Lanes E[6];
    biot_strain(F, R, E);
    const Lanes trace = E[0] + E[1] + E[2];
    const Lanes square =
        E[0] * E[0] + E[1] * E[1] + E[2] * E[2] + 2.0 * (E[3] * E[3] + E[4] * E[4] + E[5] * E[5]);
    sum += p.mu * square + 0.5 * p.lambda * trace * trace;
  }
  Real total = 0;
  for (int k = 0; k < lanes; ++k) total += sum[k];
  return total;
}

}  // namespace sutura::tissue
