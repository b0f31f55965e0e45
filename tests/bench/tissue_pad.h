// Clocks and the pad that the tissue benchmarks share.
#pragma once

#include <cmath>
#include <cstdio>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include "corotational_t4.h"
#include "node_rotations.h"
#include "smoothed_t4.h"
#include "tissue_meshes.h"
#include "tissue_solver.h"

namespace sutura::bench {

using namespace tissue;

/// Milliseconds of this worker's own time, and of the wall. Beside other work the first is the
/// fairer.
struct Clock {
  static double now(clockid_t id) {
    timespec t{};
    clock_gettime(id, &t);
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
  }
  double cpu = now(CLOCK_THREAD_CPUTIME_ID), wall = now(CLOCK_MONOTONIC);
  double cpu_ms() const { return now(CLOCK_THREAD_CPUTIME_ID) - cpu; }
  double wall_ms() const { return now(CLOCK_MONOTONIC) - wall; }
};

/// What a Tissue component does in a step, without the scene: assembly, nodal rotations, one solve
/// for the free motion, one for the constraint force.
class Pad {
 public:
  Pad(std::array<int, 3> cells, Real cell, const Material& material, Real dt, bool smoothed)
      : mesh(test::kuhn_block(cells, cell * Vec3(cells[0], cells[1], cells[2]))),
        model(smoothed ? std::unique_ptr<ElasticModel>(
                             std::make_unique<SmoothedT4>(mesh.points, mesh.tets))
                       : std::make_unique<CorotationalT4>(mesh.points, mesh.tets)),
        A(nodes(), model->pairs()),
        x(test::stacked(mesh.points)),
        v(VecX::Zero(x.size())),
        h(dt),
        size(cell * Vec3(cells[0], cells[1], cells[2])) {
    model->bind(*A.pattern());
    model->set_materials(std::vector<Material>(mesh.tets.size(), material));
    mass.assign(mesh.points.size(), 0);
    for (const Tet& t : mesh.tets) {
      const auto& p = mesh.points;
      const Real volume = std::abs(six_volume(p[t[0]], p[t[1]], p[t[2]], p[t[3]])) / 6;
      for (const Index i : t) mass[static_cast<std::size_t>(i)] += material.density * volume / 4;
    }
    for (const Vec3& p : mesh.points) fixed.push_back(p.z() < 1e-9);
  }
  Index nodes() const { return static_cast<Index>(mesh.points.size()); }

  void assemble() {
    A.set_zero();
    force.setZero(x.size());
    model->linearise(x, h * h, A, force);
    A.add_diagonal(mass, 1);
  }
  void find_rotations() { node_rotations(mesh, x, rotations); }
  /// A tool of 8 mm radius that circles over the pad and presses with `newtons`.
  VecX tool(Index step, Real newtons) const {
    const Real angle = 0.05 * static_cast<Real>(step), radius = 0.25 * std::min(size.x(), size.y());
    const Vec3 at(size.x() / 2 + radius * std::cos(angle), size.y() / 2 + radius * std::sin(angle),
                  size.z());
    VecX f = VecX::Zero(x.size());
    Real sum = 0;
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
      if (mesh.points[i].z() < size.z() - 1e-9) continue;
      const Real w = std::max(0.0, 1 - (mesh.points[i] - at).squaredNorm() / (0.008 * 0.008));
      f[3 * static_cast<Index>(i) + 2] = -w;
      sum += w;
    }
    return f * (newtons / sum);
  }
  void step(TissueSolver& solver, Index number, const VecX& pressed) {
    assemble();
    if (solver.wants_rotations()) find_rotations();
    VecX product;
    A.multiply(v, product);
    MatX b(x.size(), 1);
    for (Index i = 0; i < nodes(); ++i) {
      const Real m = mass[static_cast<std::size_t>(i)];
      b.col(0).segment<3>(3 * i) = h * (force.segment<3>(3 * i) + m * Vec3(0, 0, -9.81)) +
                                   m * v.segment<3>(3 * i) - product.segment<3>(3 * i);
    }
    solver.prepare(A, rotations, number);
    solver.solve(b);
    MatX c = h * pressed;
    solver.solve(c);
    v += b + c;
    x += h * v;
  }

  MeshData mesh;
  std::unique_ptr<ElasticModel> model;
  NodeMatrix A;
  VecX x, v, force;
  std::vector<Real> mass;
  std::vector<char> fixed;
  std::vector<Mat3> rotations;
  Real h;
  Vec3 size;
};

}  // namespace sutura::bench
