#include "elements.h"

#include "programs.h"

namespace sutura::opencl {
namespace {

constexpr std::size_t items = 128;

std::size_t at(std::int32_t i) {
  return static_cast<std::size_t>(i);
}

/// For each of `count` things, the entries of `of` that are it, ascending; `name` says what an
/// entry is called.
template <class Name>
void list_by(const std::vector<std::int32_t>& of, std::size_t count, const Name& name,
             std::vector<std::int32_t>& first, std::vector<std::int32_t>& list) {
  first.assign(count + 1, 0);
  for (const std::int32_t i : of) ++first[at(i) + 1];
  for (std::size_t i = 0; i < count; ++i) first[i + 1] += first[i];
  std::vector<std::int32_t> next = first;
  list.resize(of.size());
  for (std::size_t k = 0; k < of.size(); ++k)
    list[at(next[at(of[k])]++)] = static_cast<std::int32_t>(name(k));
}

}  // namespace

Elements::Elements(const Device& device, Precision precision)
    : device_(device),
      real_(size_of_sum(precision)),
      program_(device, precision, programs::elements) {}

void Elements::set(const TetElementsView& tets, const NodeMatrixView& pattern) {
  tets_ = static_cast<int>(tets.volume.size());
  nodes_ = static_cast<int>(pattern.nodes);
  slots_ = static_cast<int>(pattern.column.size());
  const std::vector<std::int32_t> node(tets.node.begin(), tets.node.end()),
      slot(tets.slot.begin(), tets.slot.end());
  std::vector<std::int32_t> first_corner, corner, first_part, part, diagonal_of(at(slots_), -1);
  list_by(
      node, at(nodes_), [](std::size_t k) { return k; }, first_corner, corner);
  list_by(
      slot, at(slots_), [](std::size_t k) { return 16 * (k / 10) + k % 10; }, first_part, part);
  for (std::int32_t i = 0; i < nodes_; ++i) diagonal_of[at(pattern.row_start[at(i)])] = i;
  node_.write(node);
  first_corner_.write(first_corner);
  corner_.write(corner);
  first_part_.write(first_part);
  part_.write(part);
  diagonal_of_.write(diagonal_of);
  gradient_.write(tets.gradient);
  volume_.write(tets.volume);
  moduli_.write(tets.moduli);
  const std::size_t e = at(tets_), n = at(nodes_);
  start_.reserve(4);
  of_tets_.reserve(12 * e);
  tangent_.reserve(16 * e);
  deformation_.reserve(9 * e);
  force_.reserve(3 * n);
  rotations_.reserve(9 * n);
  share_ = 0;
  device_.finish();  // of the lists above
}

void Elements::set_viscosity(const VecX& moved, Real share) {
  share_ = share;
  if (share == 0) return;
  start_.reserve(6 * at(tets_));
  moved_.write(moved);
  program_["element_start"](at(tets_), items, tets_, node_, gradient_, moved_, start_);
  device_.finish();  // `moved` may change
}

void Elements::run_elements(const VecX& moved, Real scale) {
  moved_.write(moved);
  program_["elements"](at(tets_), items, tets_, scale, share_, node_, gradient_, moduli_, start_,
                       moved_, of_tets_, tangent_, deformation_);
  program_["node_forces"](at(nodes_), items, nodes_, first_corner_, corner_, of_tets_, force_);
}

void Elements::assemble(const VecX& moved, Real scale, const VecX& diagonal, const Numbers& values,
                        VecX& force, std::vector<Mat3>& rotations) {
  run_elements(moved, scale);
  diagonal_.write(diagonal);
  program_["gather_matrix"](at(slots_), items, slots_, scale, first_part_, part_, diagonal_of_,
                            moduli_, tangent_, diagonal_, values);
  program_["node_rotations"](at(nodes_), items, nodes_, first_corner_, corner_, volume_,
                             deformation_, rotations_);
  force.resize(3 * nodes_);
  rotations.resize(at(nodes_));
  force_.read(force);
  rotations_.read({rotations.front().data(), 9 * rotations.size()});
}

void Elements::find_turns(const Numbers& then, const Numbers& turns) {
  program_["find_turns"](at(nodes_), items, nodes_, then, rotations_, turns);
}

void Elements::force(const VecX& moved, VecX& force) {
  run_elements(moved, 0);
  force.resize(3 * nodes_);
  force_.read(force);
}

}  // namespace sutura::opencl
