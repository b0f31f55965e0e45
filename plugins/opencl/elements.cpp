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

struct Elements::Program {
  Program(const Device& device, Precision precision)
      : program(device.build(definitions(precision) + programs::elements, "")),
        start(device, program, "element_start"),
        elements(device, program, "elements"),
        forces(device, program, "node_forces"),
        rotations(device, program, "node_rotations"),
        turns(device, program, "find_turns"),
        matrix(device, program, "gather_matrix") {}
  ~Program() { clReleaseProgram(program); }
  cl_program program;
  Kernel start, elements, forces, rotations, turns, matrix;
};

Elements::Elements(const Device& device, Precision precision)
    : device_(device),
      precision_(precision),
      node_(device),
      gradient_(device),
      volume_(device),
      moduli_(device),
      first_corner_(device),
      corner_(device),
      first_part_(device),
      part_(device),
      diagonal_of_(device),
      moved_(device),
      start_(device),
      of_tets_(device),
      tangent_(device),
      deformation_(device),
      diagonal_(device),
      force_(device),
      rotations_(device) {}

Elements::~Elements() = default;

void Elements::send(Buffer& to, const Real* from, Index count) {
  if (has_double_sums(precision_)) {
    to.write(from, static_cast<std::size_t>(count) * sizeof(Real));
    return;
  }
  rounded_.assign(from, from + count);
  to.write(rounded_);
  device_.finish();  // `rounded_` may change from now on
}

void Elements::receive(const Buffer& from, Real* to, Index count) {
  if (has_double_sums(precision_))
    return from.read(to, static_cast<std::size_t>(count) * sizeof(Real));
  rounded_.resize(static_cast<std::size_t>(count));
  from.read(rounded_);
  std::copy(rounded_.begin(), rounded_.end(), to);
}

void Elements::set(const TetElementsView& tets, const NodeMatrixView& pattern) {
  if (!program_) program_ = std::make_unique<Program>(device_, precision_);
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
  const auto all = [](std::span<const Real> s) { return static_cast<Index>(s.size()); };
  send(gradient_, tets.gradient.data(), all(tets.gradient));
  send(volume_, tets.volume.data(), all(tets.volume));
  send(moduli_, tets.moduli.data(), all(tets.moduli));
  const std::size_t real = has_double_sums(precision_) ? 8 : 4, e = at(tets_), n = at(nodes_);
  start_.reserve(16);
  of_tets_.reserve(12 * e * real);
  tangent_.reserve(16 * e * real);
  deformation_.reserve(9 * e * real);
  force_.reserve(3 * n * real);
  rotations_.reserve(9 * n * real);
  share_ = 0;
  device_.finish();  // of the lists above
}

void Elements::set_viscosity(const VecX& moved, Real share) {
  share_ = share;
  if (share == 0) return;
  start_.reserve(6 * at(tets_) * (has_double_sums(precision_) ? 8 : 4));
  send(moved_, moved.data(), moved.size());
  program_->start(at(tets_), items, tets_, node_, gradient_, moved_, start_);
  device_.finish();  // `moved` may change
}

void Elements::run_elements(const VecX& moved, Real scale) {
  send(moved_, moved.data(), moved.size());
  const auto run = [&](auto scale_, auto share) {
    program_->elements(at(tets_), items, tets_, scale_, share, node_, gradient_, moduli_, start_,
                       moved_, of_tets_, tangent_, deformation_);
  };
  if (has_double_sums(precision_))
    run(scale, share_);
  else
    run(static_cast<float>(scale), static_cast<float>(share_));
  program_->forces(at(nodes_), items, nodes_, first_corner_, corner_, of_tets_, force_);
}

void Elements::assemble(const VecX& moved, Real scale, const VecX& diagonal, const Buffer& values,
                        VecX& force, std::vector<Mat3>& rotations) {
  run_elements(moved, scale);
  send(diagonal_, diagonal.data(), diagonal.size());
  const auto gather = [&](auto scale_) {
    program_->matrix(at(slots_), items, slots_, scale_, first_part_, part_, diagonal_of_, moduli_,
                     tangent_, diagonal_, values);
  };
  if (has_double_sums(precision_))
    gather(scale);
  else
    gather(static_cast<float>(scale));
  program_->rotations(at(nodes_), items, nodes_, first_corner_, corner_, volume_, deformation_,
                      rotations_);
  force.resize(3 * nodes_);
  rotations.resize(at(nodes_));
  receive(force_, force.data(), force.size());
  receive(rotations_, rotations.front().data(), 9 * Index{nodes_});
}

void Elements::find_turns(const Buffer& then, const Buffer& turns) {
  program_->turns(at(nodes_), items, nodes_, then, rotations_, turns);
}

void Elements::force(const VecX& moved, VecX& force) {
  run_elements(moved, 0);
  force.resize(3 * nodes_);
  receive(force_, force.data(), force.size());
}

}  // namespace sutura::opencl
