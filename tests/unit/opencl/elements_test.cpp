// Elements on a device: the same forces, matrix and rotations as those of the CPU.
#include "elements.h"

#include <random>

#include "corotational_t4.h"
#include "gradients.h"
#include "node_rotations.h"
#include "some_device.h"
#include "tissue_meshes.h"

namespace sutura::opencl {
namespace {

using tissue::CorotationalT4;
using tissue::NodeMatrix;

/// Four layers of cells of 4 mm, two materials.
struct Block {
  Block()
      : mesh(test::kuhn_block({5, 4, 4}, 0.004 * Vec3(5, 4, 4))),
        model(mesh.points, mesh.tets),
        A(static_cast<Index>(mesh.points.size()), model.pairs()),
        rest(test::stacked(mesh.points)) {
    model.bind(*A.pattern());
    std::vector<tissue::Material> materials;
    for (std::size_t e = 0; e < mesh.tets.size(); ++e)
      materials.push_back({.young = e % 3 == 0 ? 1e5 : 1e4, .poisson = e % 3 == 0 ? 0.3 : 0.45});
    model.set_materials(materials);
  }
  NodeMatrixView pattern() const {
    return {A.nodes(), A.pattern()->row_start(), A.pattern()->column(), nullptr};
  }
  tissue::MeshData mesh;
  CorotationalT4 model;
  NodeMatrix A;
  VecX rest;
};

/// Nodes moved by up to `far` of a cell, and the whole turned.
VecX moved(const Block& block, Real far) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<Real> some(-1, 1);
  const Mat3 turn = Eigen::AngleAxis<Real>(1.1, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  VecX out(block.rest.size());
  for (Index i = 0; i < out.size(); i += 3) {
    const Vec3 p = block.rest.segment<3>(i);
    out.segment<3>(i) = turn * p - p + 0.004 * far * Vec3(some(random), some(random), some(random));
  }
  return out;
}

class DeviceElements : public OnDevice {
 protected:
  struct Made {
    VecX force, alone, values;
    std::vector<Mat3> rotations;
  };
  Made make(Block& block, const VecX& moves, const VecX& diagonal, Precision precision,
            const VecX& start, Real share) {
    Gradients gradients(*device_, precision);
    TetElementsView tets;
    Index revision = 0;
    EXPECT_TRUE(block.model.tets(tets, revision));
    gradients.set_elements(tets, block.pattern(), std::vector<char>(block.mesh.points.size(), 0));
    gradients.set_viscosity(start, share);
    Made out;
    gradients.assemble(moves, 0.01, diagonal, out.force, out.rotations);
    out.values.resize(9 * block.A.pattern()->slots());
    gradients.read_matrix({out.values.data(), static_cast<std::size_t>(out.values.size())});
    gradients.element_force(moves, out.alone);
    return out;
  }
};

// Moved by 0.05 of a cell nothing is compressed by much; by 0.4, strains are as large as one,
// negative eigenvalues are raised in both ways and tets are turned inside out; by 2, most of them
// are.
TEST_F(DeviceElements, ForcesMatrixAndRotationsAreThoseOfTheCpu) {
  for (const Real far : {0.0, 0.05, 0.4, 2.0})
    for (const Real share : {0.0, 0.6})
      for (const Precision precision : {Precision::double_, Precision::mixed, Precision::single}) {
        if (has_double_sums(precision) && !device_->has_double()) continue;
        SCOPED_TRACE(std::to_string(far) + " " + std::to_string(share) + " " +
                     std::to_string(static_cast<int>(precision)));
        Block block;
        const VecX moves = moved(block, far), start = moved(block, 0.5 * far);
        VecX diagonal(moves.size());
        for (Index i = 0; i < diagonal.size(); ++i) diagonal[i] = 0.001 * static_cast<Real>(i);
        block.model.set_viscosity(block.rest + start, share);
        VecX force = VecX::Zero(moves.size());
        block.model.linearise(block.rest + moves, 0.01, block.A, force);
        for (Index i = 0; i < moves.size(); ++i)
          block.A.values()[9 * block.A.pattern()->diagonal(i / 3) + 4 * (i % 3)] += diagonal[i];
        const Eigen::Map<const VecX> values(block.A.values(), 9 * block.A.pattern()->slots());
        std::vector<Mat3> rotations;
        tissue::node_rotations(block.mesh, block.rest + moves, rotations);

        const Made made = make(block, moves, diagonal, precision, start, share);
        const bool digits = has_double_sums(precision);
        // The Newton iteration of the CPU leaves 1e-9 of a modulus where it raises eigenvalues.
        EXPECT_LT((made.force - force).norm(), (digits ? 1e-11 : 2e-5) * (1 + force.norm()));
        EXPECT_LT((made.alone - force).norm(), (digits ? 1e-11 : 2e-5) * (1 + force.norm()));
        EXPECT_LT((made.values - values).norm() / values.norm(),
                  precision == Precision::double_ ? 1e-8 : (digits ? 1e-7 : 1e-4));
        Real worst = 0;
        for (std::size_t i = 0; i < rotations.size(); ++i)
          worst = std::max(worst, (made.rotations[i] - rotations[i]).norm());
        EXPECT_LT(worst, digits ? 1e-9 : 1e-3);

        const Made again = make(block, moves, diagonal, precision, start, share);
        EXPECT_TRUE(made.force == again.force && made.values == again.values);
        for (std::size_t i = 0; i < rotations.size(); ++i)
          EXPECT_TRUE(made.rotations[i] == again.rotations[i]);
      }
}

// A state that is not finite stays one that is seen.
TEST_F(DeviceElements, WhatIsNotFiniteShows) {
  Block block;
  VecX moves = VecX::Zero(block.rest.size());
  moves[30] = std::numeric_limits<Real>::quiet_NaN();
  const Made made = make(block, moves, VecX::Ones(moves.size()),
                         choose(Precision::automatic, *device_), moves, 0);
  EXPECT_FALSE(made.force.allFinite());
}

}  // namespace
}  // namespace sutura::opencl
