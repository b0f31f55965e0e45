#include "smoothed_t4.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "strain.h"
#include "twist_stiffness.h"

namespace sutura::tissue {

SmoothedT4::SmoothedT4(const std::vector<Vec3>& rest, const std::vector<Tet>& tets)
    : node_count_(static_cast<Index>(rest.size())), tets_(tets) {
  for (const Tet& t : tets) {
    const Mat3 D = tet_edges(t, rest);
    Eigen::Matrix<Real, 3, 4> g;
    g.rightCols<3>() = D.inverse().transpose();
    g.col(0) = -g.rightCols<3>().rowwise().sum();
    gradient_.push_back(g);
    volume_.push_back(std::abs(D.determinant()) / 6);
  }
}

/// The nodal average couples every two neighbours of a node; the edges add nothing to that.
std::vector<std::array<Index, 2>> SmoothedT4::pairs() const {
  std::vector<std::vector<Index>> around(static_cast<std::size_t>(node_count_));
  for (const Tet& t : tets_)
    for (const Index i : t)
      around[static_cast<std::size_t>(i)].insert(around[i].end(), t.begin(), t.end());
  std::vector<std::array<Index, 2>> pairs;
  for (std::vector<Index>& nodes : around) {
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    for (std::size_t a = 0; a < nodes.size(); ++a)
      for (std::size_t b = a + 1; b < nodes.size(); ++b) pairs.push_back({nodes[a], nodes[b]});
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

void SmoothedT4::bind(const NodePattern& pattern) {
  pattern_ = &pattern;
  find_slots(edges_);
  find_slots(nodes_);
}

void SmoothedT4::set_materials(const std::vector<Material>& per_tet) {
  assert(per_tet.size() == tets_.size());
  std::map<std::pair<Real, Real>, int> numbers;
  std::vector<Material> materials;
  std::vector<Share> edges, nodes;
  for (std::size_t e = 0; e < tets_.size(); ++e) {
    const auto [it, is_new] = numbers.try_emplace({per_tet[e].young, per_tet[e].poisson},
                                                  static_cast<int>(materials.size()));
    if (is_new) materials.push_back(per_tet[e]);
    for (std::size_t a = 0; a < 4; ++a) {
      nodes.push_back({tets_[e][a], tets_[e][a], it->second, e});
      for (std::size_t b = a + 1; b < 4; ++b)
        edges.push_back({std::min(tets_[e][a], tets_[e][b]), std::max(tets_[e][a], tets_[e][b]),
                         it->second, e});
    }
  }
  edges_ = make_domains(std::move(edges), materials, true);
  nodes_ = make_domains(std::move(nodes), materials, false);
  if (pattern_) bind(*pattern_);
}

/// A tet gives a sixth of its volume to each of its edges, a quarter to each of its nodes.
SmoothedT4::Domains SmoothedT4::make_domains(std::vector<Share> shares,
                                             const std::vector<Material>& materials,
                                             bool shear) const {
  struct Domain {
    Real volume = 0;
    int material = 0;
    std::map<Index, Vec3> gradient;  // node -> its gradient
  };
  const auto key = [](const Share& s) { return std::tuple(s.first, s.second, s.material, s.tet); };
  std::sort(shares.begin(), shares.end(),
            [&](const Share& a, const Share& b) { return key(a) < key(b); });
  const Real part = shear ? 1.0 / 6 : 1.0 / 4;
  std::vector<Domain> domains;
  for (std::size_t s = 0; s < shares.size(); ++s) {
    const bool same = s > 0 && shares[s].first == shares[s - 1].first &&
                      shares[s].second == shares[s - 1].second &&
                      shares[s].material == shares[s - 1].material;
    if (!same) domains.emplace_back();
    Domain& d = domains.back();
    d.material = shares[s].material;
    const std::size_t e = shares[s].tet;
    d.volume += part * volume_[e];
    for (int c = 0; c < 4; ++c)
      d.gradient.try_emplace(tets_[e][static_cast<std::size_t>(c)], Vec3::Zero()).first->second +=
          part * volume_[e] * gradient_[e].col(c);
  }
  // Packs of domains with about as many nodes; neighbours stay together otherwise.
  std::stable_sort(domains.begin(), domains.end(), [](const Domain& a, const Domain& b) {
    return a.gradient.size() < b.gradient.size();
  });

  Domains out;
  out.shear = shear;
  for (std::size_t first = 0; first < domains.size(); first += lanes) {
    Pack p{};
    const std::size_t last = std::min(first + lanes, domains.size()) - 1;
    p.count = static_cast<std::int32_t>(domains[last].gradient.size());
    p.gradient = out.gradients.size();
    p.node = out.nodes.size();
    p.slot = out.slots.size();
    out.gradients.resize(p.gradient + static_cast<std::size_t>(p.count));
    out.nodes.resize(p.node + static_cast<std::size_t>(lanes * p.count));
    out.slots.resize(p.slot + static_cast<std::size_t>(lanes * p.count * (p.count + 1) / 2), -1);
    for (int k = 0; k < lanes; ++k) {
      const Domain& d = domains[std::min(first + static_cast<std::size_t>(k), last)];
      std::size_t a = 0;
      for (const auto& [node, gradient] : d.gradient) {
        for (int i = 0; i < 3; ++i) out.gradients[p.gradient + a].at[i][k] = gradient[i] / d.volume;
        out.nodes[p.node + lanes * a++ + static_cast<std::size_t>(k)] =
            static_cast<std::int32_t>(node);
      }
      for (; a < static_cast<std::size_t>(p.count); ++a) {
        for (int i = 0; i < 3; ++i) out.gradients[p.gradient + a].at[i][k] = 0;
        out.nodes[p.node + lanes * a + static_cast<std::size_t>(k)] =
            out.nodes[p.node + static_cast<std::size_t>(k)];
      }
      const bool repeated = first + static_cast<std::size_t>(k) > last;
      const Real volume = repeated ? 0 : d.volume;
      const Material& m = materials[static_cast<std::size_t>(d.material)];
      // Deviator: mu |E|^2 - mu/3 tr(E)^2. Volume: (lambda/2 + mu/3) tr(E)^2.
      p.mu[k] = shear ? volume * m.lame_mu() : 0;
      p.lambda[k] = volume * (shear ? -2 * m.lame_mu() / 3 : m.lame_lambda() + 2 * m.lame_mu() / 3);
    }
    out.packs.push_back(p);
  }
  return out;
}

void SmoothedT4::find_slots(Domains& d) const {
  for (const Pack& p : d.packs)
    for (int k = 0; k < lanes; ++k) {
      const auto node = [&](std::int32_t a) {
        return static_cast<Index>(d.nodes[p.node + static_cast<std::size_t>(lanes * a + k)]);
      };
      std::size_t s = p.slot + static_cast<std::size_t>(k);
      for (std::int32_t a = 0; a < p.count; ++a)
        for (std::int32_t b = a; b < p.count; ++b, s += lanes) {
          // Fillers repeat the first node and add zeros to its block.
          const Index slot = pattern_->slot(std::min(node(a), node(b)), std::max(node(a), node(b)));
          assert(slot >= 0);
          d.slots[s] = static_cast<std::int32_t>(slot);
        }
    }
}

void SmoothedT4::deformation_gradient(const Domains& d, const Pack& p, const VecX& x,
                                      Small3<Lanes>& F) const {
  for (Lanes& f : F) f = Lanes{};
  const std::int32_t* node = &d.nodes[p.node];
  Lanes origin[3];
  for (int k = 0; k < lanes; ++k)
    for (int i = 0; i < 3; ++i) origin[i][k] = x[3 * static_cast<Index>(node[k]) + i];
  for (std::int32_t a = 1; a < p.count; ++a) {
    node += lanes;
    const Lanes* G = d.gradients[p.gradient + static_cast<std::size_t>(a)].at;
    Lanes X[3];
    for (int k = 0; k < lanes; ++k) {
      const Real* at = x.data() + 3 * static_cast<Index>(node[k]);
      for (int i = 0; i < 3; ++i) X[i][k] = at[i];
    }
    for (int i = 0; i < 3; ++i) {
      const Lanes u = X[i] - origin[i];
      for (int j = 0; j < 3; ++j) F[3 * j + i] += u * G[j];
    }
  }
}

template <bool shear>
void SmoothedT4::stress(const Domains& d, const Pack& p, const VecX& x, Stressed& s,
                        VecX& force) const {
  Small3<Lanes> F;
  deformation_gradient(d, p, x, F);
  const Small3<Lanes>& R = s.R;
  rotations(F, s.R);
  biot_strain(F, R, s.E);
  const Real stiffer = add_viscosity(viscous_share_, p.start, s.E);
  const Lanes(&E)[6] = s.E;
  const Lanes pressure = stiffer * p.lambda * (E[0] + E[1] + E[2]);
  const Lanes two_mu = 2.0 * stiffer * p.mu;
  const auto count = static_cast<std::size_t>(p.count);
  if (s.turned.size() < count) s.turned.resize(count);
  for (std::size_t a = 0; a < count; ++a) {
    const Lanes* G = d.gradients[p.gradient + a].at;
    Lanes* g = s.turned[a].at;
    for (int i = 0; i < 3; ++i) g[i] = R[i] * G[0] + R[3 + i] * G[1] + R[6 + i] * G[2];
    Lanes t[3];  // R T G, T the stress times volume
    if constexpr (shear) {
      const Lanes TG[3] = {
          (two_mu * E[0] + pressure) * G[0] + two_mu * (E[3] * G[1] + E[4] * G[2]),
          (two_mu * E[1] + pressure) * G[1] + two_mu * (E[3] * G[0] + E[5] * G[2]),
          (two_mu * E[2] + pressure) * G[2] + two_mu * (E[4] * G[0] + E[5] * G[1])};
      for (int i = 0; i < 3; ++i) t[i] = R[i] * TG[0] + R[3 + i] * TG[1] + R[6 + i] * TG[2];
    } else {
      for (int i = 0; i < 3; ++i) t[i] = pressure * g[i];
    }
    const std::int32_t* node = &d.nodes[p.node + lanes * a];
    for (int k = 0; k < lanes; ++k) {
      Real* at = force.data() + 3 * static_cast<Index>(node[k]);
      for (int i = 0; i < 3; ++i) at[i] -= t[i][k];
    }
  }
}

void SmoothedT4::add_force(const VecX& x, VecX& force) const {
  for (const Pack& p : edges_.packs) stress<true>(edges_, p, x, work_, force);
  for (const Pack& p : nodes_.packs) stress<false>(nodes_, p, x, work_, force);
}

template <bool shear>
void SmoothedT4::add(const Domains& d, const VecX& x, Real scale, NodeMatrix& A, VecX& force) {
  Real* const values = A.values();
  for (const Pack& p : d.packs) {
    stress<shear>(d, p, x, work_, force);
    const Turned& turned = work_.turned;
    const auto count = static_cast<std::size_t>(p.count);
    Lanes twist[6];
    twist_stiffness(work_.E, p.mu, p.lambda, twist);
    turn_symmetric(work_.R.data(), twist);
    for (Lanes& t : twist) t *= 0.5 * scale;

    // K_ab = V (lambda g_a g_b^T + mu g_b g_a^T + mu g_a . g_b I), and twist
    const Lanes mu = scale * p.mu, lambda = scale * p.lambda;
    const std::int32_t* slot = &d.slots[p.slot];
    for (std::size_t a = 0; a < count; ++a) {
      const Lanes* ga = turned[a].at;
      Lanes la[3], ma[3];
      for (int i = 0; i < 3; ++i) {
        la[i] = lambda * ga[i];
        ma[i] = mu * ga[i];
      }
      for (std::size_t b = a; b < count; ++b, slot += lanes) {
        const Lanes* gb = turned[b].at;
        Lanes K[9];
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) {
            K[3 * i + j] = la[i] * gb[j];
            if constexpr (shear) K[3 * i + j] += gb[i] * ma[j];
          }
        if constexpr (shear) {
          const Lanes dot = ma[0] * gb[0] + ma[1] * gb[1] + ma[2] * gb[2];
          for (int i = 0; i < 3; ++i) K[4 * i] += dot;
        }
        add_twist(twist, ga, gb, K);
        for (int k = 0; k < lanes; ++k) {
          Real* block = values + 9 * static_cast<Index>(slot[k]);
          for (int i = 0; i < 9; ++i) block[i] += K[i][k];
        }
      }
    }
  }
}

void SmoothedT4::linearise(const VecX& x, Real scale, NodeMatrix& A, VecX& force) {
  assert(pattern_ && !nodes_.packs.empty());
  add<true>(edges_, x, scale, A, force);
  add<false>(nodes_, x, scale, A, force);
}

void SmoothedT4::set_viscosity(const VecX& start, Real share) {
  viscous_share_ = share;
  if (share == 0) return;
  for (Domains* d : {&edges_, &nodes_})
    for (Pack& p : d->packs) {
      Small3<Lanes> F, R;
      deformation_gradient(*d, p, start, F);
      rotations(F, R);
      biot_strain(F, R, p.start);
    }
}

Real SmoothedT4::energy(const VecX& x) const {
  Real total = 0;
  for (const Domains* d : {&edges_, &nodes_})
    for (const Pack& p : d->packs) {
      Small3<Lanes> F, R;
      deformation_gradient(*d, p, x, F);
      rotations(F, R);
      Lanes E[6];
      biot_strain(F, R, E);
      const Lanes trace = E[0] + E[1] + E[2];
      const Lanes square =
          E[0] * E[0] + E[1] * E[1] + E[2] * E[2] + 2.0 * (E[3] * E[3] + E[4] * E[4] + E[5] * E[5]);
      const Lanes energy = p.mu * square + 0.5 * p.lambda * trace * trace;
      for (int k = 0; k < lanes; ++k) total += energy[k];
    }
  return total;
}

}  // namespace sutura::tissue
