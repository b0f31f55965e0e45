// A block of corotational tetrahedra, assembled the plain way: systems for the tests of the solvers
// that do not depend on the element code of the room.
#pragma once

#include <Eigen/SVD>
#include <array>
#include <cmath>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "block_matrix.h"
#include "tissue_solver.h"

namespace sutura::testing {

using namespace tissue;

struct Grid {
  std::vector<Vec3> rest;
  std::vector<std::array<Index, 4>> tets;
  std::vector<char> fixed;  ///< the face x = 0
};

/// nx * ny * nz cells of `cell` metres, six tetrahedra each around the diagonal from the lowest to
/// the highest corner.
inline Grid make_grid(Index nx, Index ny, Index nz, Real cell) {
  Grid g;
  const auto id = [&](Index i, Index j, Index k) { return (k * (ny + 1) + j) * (nx + 1) + i; };
  for (Index k = 0; k <= nz; ++k)
    for (Index j = 0; j <= ny; ++j)
      for (Index i = 0; i <= nx; ++i) {
        g.rest.push_back(cell * Vec3(Real(i), Real(j), Real(k)));
        g.fixed.push_back(i == 0);
      }
  const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  for (Index k = 0; k < nz; ++k)
    for (Index j = 0; j < ny; ++j)
      for (Index i = 0; i < nx; ++i)
        for (const auto& order : orders) {
          std::array<Index, 3> at{i, j, k};
          std::array<Index, 4> t{id(i, j, k), 0, 0, 0};
          for (int s = 0; s < 3; ++s) {
            ++at[static_cast<std::size_t>(order[s])];
            t[static_cast<std::size_t>(s) + 1] = id(at[0], at[1], at[2]);
          }
          const Vec3 &a = g.rest[static_cast<std::size_t>(t[0])],
                     &b = g.rest[static_cast<std::size_t>(t[1])],
                     &c = g.rest[static_cast<std::size_t>(t[2])],
                     &d = g.rest[static_cast<std::size_t>(t[3])];
          if ((b - a).cross(c - a).dot(d - a) < 0) std::swap(t[2], t[3]);
          g.tets.push_back(t);
        }
  return g;
}

struct Elasticity {
  Real young = 10e3, poisson = 0.45, density = 1000;
};

inline Mat3 polar_rotation(const Mat3& F) {
  const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0) U.col(2) *= -1;
  return U * svd.matrixV().transpose();
}

inline NodeMatrix make_matrix(const Grid& g) {
  std::vector<Index> nodes;
  for (const auto& t : g.tets) nodes.insert(nodes.end(), t.begin(), t.end());
  return NodeMatrix(static_cast<Index>(g.rest.size()), pairs_of_elements(nodes, 4));
}

/// A = M + h^2 K at positions x; `rotations` per node: polar factor of the volume-weighted mean of
/// the deformation gradients around it; `force`, if asked for, -dE/dx; `masses` of the nodes
/// likewise.
inline void assemble(const Grid& g, const std::vector<Vec3>& x, const Elasticity& e, Real h,
                     NodeMatrix& A, std::vector<Mat3>& rotations, VecX* force = nullptr,
                     std::vector<Real>* masses = nullptr) {
  const Real mu = e.young / (2 * (1 + e.poisson));
  const Real lambda = e.young * e.poisson / ((1 + e.poisson) * (1 - 2 * e.poisson));
  A.set_zero();
  std::vector<Real> mass(g.rest.size(), 0);
  rotations.assign(g.rest.size(), Mat3::Zero());
  if (force) force->setZero(3 * static_cast<Index>(g.rest.size()));
  for (const auto& t : g.tets) {
    Mat3 Dm, Ds;
    for (int a = 0; a < 3; ++a) {
      const auto i = static_cast<std::size_t>(t[static_cast<std::size_t>(a) + 1]);
      const auto o = static_cast<std::size_t>(t[0]);
      Dm.col(a) = g.rest[i] - g.rest[o];
      Ds.col(a) = x[i] - x[o];
    }
    const Real volume = Dm.determinant() / 6;
    const Mat3 inverse = Dm.inverse();
    const Mat3 F = Ds * inverse;
    const Mat3 R = polar_rotation(F);
    Eigen::Matrix<Real, 3, 4> gradient;
    gradient.rightCols<3>() = R * inverse.transpose();
    gradient.col(0) = -gradient.rightCols<3>().rowwise().sum();
    const Mat3 strain = 0.5 * (R.transpose() * F + F.transpose() * R) - Mat3::Identity();
    const Mat3 stress =  // in the axes of the deformed element
        R * (2 * mu * strain + lambda * strain.trace() * Mat3::Identity()) * R.transpose();
    for (int a = 0; a < 4; ++a) {
      const Index i = t[static_cast<std::size_t>(a)];
      if (force) force->segment<3>(3 * i) -= volume * stress * gradient.col(a);
      mass[static_cast<std::size_t>(i)] += e.density * volume / 4;
      rotations[static_cast<std::size_t>(i)] += volume * F;
      for (int b = 0; b < 4; ++b) {
        const Index j = t[static_cast<std::size_t>(b)];
        if (i > j) continue;
        const Vec3 ga = gradient.col(a), gb = gradient.col(b);
        const Mat3 K = volume * (lambda * ga * gb.transpose() + mu * gb * ga.transpose() +
                                 mu * ga.dot(gb) * Mat3::Identity());
        Eigen::Map<Eigen::Matrix<Real, 3, 3, Eigen::RowMajor>>(A.values() + 9 * A.slot(i, j)) +=
            h * h * K;
      }
    }
  }
  A.add_diagonal(mass, 1);
  for (Mat3& r : rotations) r = polar_rotation(r);
  if (masses) *masses = mass;
}

/// A block that falls, swings and comes to rest, one linearised implicit Euler step at a time.
struct Swing {
  explicit Swing(Grid g) : grid(std::move(g)) {}
  Grid grid;
  Elasticity material;
  Real h = 0.02;
  Vec3 gravity{0, 0, -9.81};
  std::vector<Vec3> x = grid.rest;
  VecX v = VecX::Zero(3 * static_cast<Index>(grid.rest.size()));
  NodeMatrix A = make_matrix(grid);
  std::vector<Mat3> rotations;
  VecX force;
  std::vector<Real> mass;
  Index count = 0;

  void begin(TissueSolver& solver, std::span<const Index> candidates = {}) {
    solver.analyse(A.pattern(), grid.fixed, candidates);
  }
  /// A dv = h f - h^2 K v, damping aside.
  VecX right_hand_side() {
    assemble(grid, x, material, h, A, rotations, &force, &mass);
    VecX b;
    A.multiply(v, b);
    for (Index i = 0; i < A.nodes(); ++i) {
      const Real m = mass[static_cast<std::size_t>(i)];
      b.segment<3>(3 * i) = grid.fixed[static_cast<std::size_t>(i)]
                                ? Vec3(Vec3::Zero())
                                : Vec3(h * (force.segment<3>(3 * i) + m * gravity) +
                                       m * v.segment<3>(3 * i) - b.segment<3>(3 * i));
    }
    return b;
  }
  void step(TissueSolver& solver) {
    MatX dv = right_hand_side();
    solver.prepare(A, rotations, count++);
    solver.solve(dv);
    v += dv;
    for (Index i = 0; i < A.nodes(); ++i) x[static_cast<std::size_t>(i)] += h * v.segment<3>(3 * i);
  }
};

inline std::vector<Vec3> deform(const Grid& g, const std::function<Vec3(const Vec3&)>& map) {
  std::vector<Vec3> x;
  for (const Vec3& X : g.rest) x.push_back(map(X));
  return x;
}

/// Bends a beam along x of the given length by `angle` (rad) about y, keeping the length of z =
/// middle.
inline std::function<Vec3(const Vec3&)> bend(Real length, Real angle, Real middle) {
  return [=](const Vec3& X) {
    if (angle == 0) return X;
    const Real radius = length / angle, t = X.x() / radius, r = radius - (X.z() - middle);
    return Vec3(r * std::sin(t), X.y(), middle + radius - r * std::cos(t));
  };
}

inline std::function<Vec3(const Vec3&)> twist(Real length, Real angle, const Vec3& axis_point) {
  return [=](const Vec3& X) {
    const Eigen::AngleAxis<Real> turn(angle * X.x() / length, Vec3::UnitX());
    return Vec3(axis_point + turn * (X - axis_point));
  };
}

/// Dense A with the rows and columns of fixed nodes replaced by the identity.
inline MatX dense(const NodeMatrix& A, const std::vector<char>& fixed) {
  MatX D = MatX::Zero(3 * A.nodes(), 3 * A.nodes());
  for (Index i = 0; i < A.nodes(); ++i)
    for (Index j = 0; j < A.nodes(); ++j) {
      const bool out = fixed[static_cast<std::size_t>(i)] || fixed[static_cast<std::size_t>(j)];
      D.block<3, 3>(3 * i, 3 * j) =
          out ? (i == j ? Mat3(Mat3::Identity()) : Mat3(Mat3::Zero())) : A.block(i, j);
    }
  return D;
}

/// A right-hand side with every frequency in it, zero at fixed nodes. Reproducible everywhere.
inline VecX rough_vector(const std::vector<char>& fixed, std::uint32_t seed = 1) {
  VecX b(3 * static_cast<Index>(fixed.size()));
  std::uint32_t state = seed;
  for (Index i = 0; i < b.size(); ++i) {
    state = state * 1664525u + 1013904223u;
    b[i] = fixed[static_cast<std::size_t>(i / 3)] ? 0 : Real(state >> 8) / Real(1u << 24) - 0.5;
  }
  return b;
}

}  // namespace sutura::testing
