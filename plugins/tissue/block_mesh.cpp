#include "block_mesh.h"

#include <algorithm>
#include <cmath>

#include "cut_mesh.h"

namespace sutura::tissue {

namespace {

constexpr Real rounding = 1e-6;  // of the size of a cut

/// The nodes that only holes had.
void drop_unused(MeshData& mesh) {
  std::vector<Index> number(mesh.points.size(), -1);
  for (const Tet& tet : mesh.tets)
    for (const Index i : tet) number[static_cast<std::size_t>(i)] = 0;
  Index count = 0;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] < 0) continue;
    mesh.points[static_cast<std::size_t>(count)] = mesh.points[i];
    number[i] = count++;
  }
  mesh.points.resize(static_cast<std::size_t>(count));
  for (Tet& tet : mesh.tets)
    for (Index& i : tet) i = number[static_cast<std::size_t>(i)];
}

}  // namespace

void BlockMesh::describe(Describe<BlockMesh>& d) {
  d.summary(
      "A tetrahedral mesh of a block, made from its corners: a box, or any body with six faces, "
      "with or without holes and cuts.");
  d.theory(
      "The block is cut into cells and each cell into six tetrahedra around the diagonal from its "
      "lowest to its highest corner (Kuhn). With `corners` a point at the shares *a, b, c* of the "
      "three directions is the trilinear mean of the eight. All of it is one region, number 0. "
      "Along a cut the nodes are there twice, but where it ends within the block.");
  d.attribute("box", &BlockMesh::box, "m", any(), "Two opposite corners of a box.");
  d.attribute("corners", &BlockMesh::corners, "m", any(),
              "Eight corners instead: the first runs fastest along direction 1, then 2, then 3.");
  d.attribute("cells", &BlockMesh::cells, "1", between(1, 1000),
              "Number of cells along each of the three directions.")
      .required();
  d.attribute("holes", &BlockMesh::holes, "m", any(),
              "Boxes, two corners each: cells whose middle lies in one are left out.");
  d.attribute("cuts", &BlockMesh::cuts, "m", any(),
              "Flat boxes, two corners each: sides of cells that lie in one are cut open, without "
              "a gap. A Contact of the tissue with itself keeps the walls apart.");
  d.output("nodes", "1", "Number of nodes.",
           [](const BlockMesh& m) -> Real { return static_cast<Real>(m.data().points.size()); });
  d.output("tets", "1", "Number of tetrahedra.",
           [](const BlockMesh& m) -> Real { return static_cast<Real>(m.data().tets.size()); });
}

void BlockMesh::initialise(Setup& setup) {
  if (box.empty() == corners.empty())
    return setup.error(*this, "one of 'box' and 'corners' is needed, and not both");
  if (!box.empty() && box.size() != 6)
    return setup.error(
        *this, "'box' has " + std::to_string(box.size()) + " numbers, expected 6: two corners");
  if (!corners.empty() && corners.size() != 24)
    return setup.error(*this, "'corners' has " + std::to_string(corners.size()) +
                                  " numbers, expected 24: eight corners");
  if (holes.size() % 6 != 0)
    return setup.error(*this, "'holes' has " + std::to_string(holes.size()) +
                                  " numbers, expected 6 for each hole: two corners");
  if (cuts.size() % 6 != 0)
    return setup.error(*this, "'cuts' has " + std::to_string(cuts.size()) +
                                  " numbers, expected 6 for each cut: two corners");
  std::array<Index, 3> n{};
  Real tets = 6;
  if (cells.size() != 3)
    return setup.error(*this, "'cells' has " + std::to_string(cells.size()) +
                                  " numbers, expected 3: one for each direction");
  for (std::size_t k = 0; k < 3; ++k) {
    if (cells[k] != std::floor(cells[k]))
      return setup.error(*this, "'cells' are counted in whole numbers");
    n[k] = static_cast<Index>(cells[k]);
    tets *= cells[k];
  }
  constexpr Real most = 3e6;  // about 2 GB of matrix
  if (tets > most) return setup.error(*this, "'cells' make more than 3 000 000 tetrahedra");

  std::array<Vec3, 8> corner;
  for (std::size_t i = 0; i < 8; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const bool far = (i >> k & 1) != 0;
      corner[i][static_cast<Index>(k)] =
          corners.empty() ? (far ? std::max(box[k], box[k + 3]) : std::min(box[k], box[k + 3]))
                          : corners[3 * i + k];
    }
  if (!box.empty() && !((corner[7] - corner[0]).minCoeff() > 0))
    return setup.error(*this, "'box' is flat: its two corners must differ in x, y and z");
  MeshData mesh = build(corner, n);
  if (mesh.tets.empty()) return setup.error(*this, "'holes' leave nothing of the block");
  if (const std::string wrong = open_cuts(mesh); !wrong.empty()) return setup.error(*this, wrong);
  take(std::move(mesh), "the block", setup);
}

std::string BlockMesh::open_cuts(MeshData& mesh) const {
  std::vector<Index> sides(cuts.size() / 6, 0);  // by cut
  const auto number = [](std::size_t cut) { return "'cuts', number " + std::to_string(cut + 1); };
  for (std::size_t c = 0; c < sides.size(); ++c) {
    const Vec3 size = (corner_of_cut(c, 0) - corner_of_cut(c, 1)).cwiseAbs();
    if (size.minCoeff() > rounding * size.maxCoeff())
      return number(c) + ", is not flat; 'holes' are what has a thickness";
  }
  // All at once: where two meet, a node comes apart by both.
  cut_open(mesh, [&](const std::array<Vec3, 3>& face) {
    bool any = false;
    for (std::size_t c = 0; c < sides.size(); ++c) {
      const Vec3 a = corner_of_cut(c, 0), b = corner_of_cut(c, 1);
      const Real near = rounding * (a - b).cwiseAbs().maxCoeff();
      const bool within = std::all_of(face.begin(), face.end(), [&](const Vec3& p) {
        return ((p - a.cwiseMin(b)).array() >= -near).all() &&
               ((a.cwiseMax(b) - p).array() >= -near).all();
      });
      sides[c] += within;
      any = any || within;
    }
    return any;
  });
  for (std::size_t c = 0; c < sides.size(); ++c)
    if (sides[c] == 0)
      return number(c) + ", holds no side of a cell; it must lie between cells, see 'cells'";
  if (!cuts.empty() && mesh.copied_nodes == 0)
    return "'cuts' open nothing: all nodes are at the end of a cut; within the block one must be "
           "two cells wide at least";
  return {};
}

Vec3 BlockMesh::corner_of_cut(std::size_t cut, std::size_t corner) const {
  const Real* at = cuts.data() + 6 * cut + 3 * corner;
  return {at[0], at[1], at[2]};
}

MeshData BlockMesh::build(const std::array<Vec3, 8>& corner, const std::array<Index, 3>& n) const {
  const auto at = [&](const Vec3& share) {
    Vec3 p = Vec3::Zero();
    for (std::size_t i = 0; i < 8; ++i) {
      Real weight = 1;
      for (Index k = 0; k < 3; ++k) weight *= (i >> k & 1) != 0 ? share[k] : 1 - share[k];
      p += weight * corner[i];
    }
    return p;
  };
  const auto share_of = [&](Real i, Real j, Real k) {
    return Vec3(i / static_cast<Real>(n[0]), j / static_cast<Real>(n[1]),
                k / static_cast<Real>(n[2]));
  };
  const auto is_hole = [&](const Vec3& p) {
    for (std::size_t h = 0; h < holes.size(); h += 6) {
      const Vec3 a(holes[h], holes[h + 1], holes[h + 2]);
      const Vec3 b(holes[h + 3], holes[h + 4], holes[h + 5]);
      if (((p - a.cwiseMin(b)).array() > 0).all() && ((a.cwiseMax(b) - p).array() > 0).all())
        return true;
    }
    return false;
  };
  const auto node = [&](Index i, Index j, Index k) {
    return i + (n[0] + 1) * (j + (n[1] + 1) * k);
  };
  MeshData mesh;
  for (Index k = 0; k <= n[2]; ++k)
    for (Index j = 0; j <= n[1]; ++j)
      for (Index i = 0; i <= n[0]; ++i)
        mesh.points.push_back(
            at(share_of(static_cast<Real>(i), static_cast<Real>(j), static_cast<Real>(k))));
  // The six ways from the lowest corner of a cell to its highest, one direction at a time.
  // Every other one is a mirror image of the one before: its last two nodes change places.
  constexpr std::array<std::array<int, 3>, 6> ways{
      {{0, 1, 2}, {0, 2, 1}, {1, 2, 0}, {1, 0, 2}, {2, 0, 1}, {2, 1, 0}}};
  for (Index k = 0; k < n[2]; ++k)
    for (Index j = 0; j < n[1]; ++j)
      for (Index i = 0; i < n[0]; ++i) {
        const Vec3 middle = at(share_of(static_cast<Real>(i) + 0.5, static_cast<Real>(j) + 0.5,
                                        static_cast<Real>(k) + 0.5));
        if (is_hole(middle)) continue;
        for (std::size_t w = 0; w < ways.size(); ++w) {
          std::array<Index, 3> c{i, j, k};
          Tet tet{};
          tet[0] = node(c[0], c[1], c[2]);
          for (std::size_t step = 0; step < 3; ++step) {
            ++c[static_cast<std::size_t>(ways[w][step])];
            tet[step + 1] = node(c[0], c[1], c[2]);
          }
          if (w % 2 == 1) std::swap(tet[2], tet[3]);
          mesh.tets.push_back(tet);
        }
      }
  mesh.region.assign(mesh.tets.size(), 0);
  drop_unused(mesh);
  return mesh;
}

}  // namespace sutura::tissue
