#include "assembly.h"

#include "node_rotations.h"

namespace sutura::tissue {

void Assembly::begin(const VecX& start, Real h) {
  start_ = start;
  share_ = model_.damping_stiffness / (h + model_.damping_stiffness);
  begun_here_ = begun_there_ = false;
}

void Assembly::begin_here() {
  if (!begun_here_) model_.elastic->set_viscosity(start_, share_);
  begun_here_ = true;
}

const VecX& Assembly::moved(const VecX& x) {
  moved_ = x - model_.rest;
  return moved_;
}

ConjugateGradientDevice* Assembly::device_for(const NodePattern& pattern) {
  ConjugateGradientDevice* const device = solver_.device();
  TetElementsView tets;
  Index revision = 0;
  if (device == nullptr || !model_.followers.empty() || !model_.elastic->tets(tets, revision))
    return nullptr;
  if (revision_ != revision) {
    const NodeMatrixView view{pattern.nodes(), pattern.row_start(), pattern.column(), nullptr};
    if (!device->set_elements(tets, view, model_.held.fixed())) return nullptr;
    revision_ = revision;
    begun_there_ = false;
  }
  if (!begun_there_ && !device->set_viscosity(moved(start_), share_)) return nullptr;
  begun_there_ = true;
  return device;
}

void Assembly::linearise_here(const VecX& x, Real h, NodeMatrix& A, VecX& force) {
  begin_here();
  A.set_zero();
  force.setZero(x.size());
  model_.elastic->linearise(x, h * h + h * model_.damping_stiffness, A, force);
  model_.held.add_stiffness(h * h, A);
  for (const FollowerLoad* follower : model_.followers) follower->add_stiffness(x, h * h, A);
  A.add_diagonal(model_.mass, 1 + h * model_.damping_mass);
}

void Assembly::linearise(const VecX& x, Real h, NodeMatrix& A, VecX& force,
                         std::vector<Mat3>& rotations) {
  if (ConjugateGradientDevice* const device = device_for(*A.pattern())) {
    diagonal_.resize(x.size());
    for (Index i = 0; i < A.nodes(); ++i)
      diagonal_.segment<3>(3 * i).setConstant((1 + h * model_.damping_mass) *
                                              model_.mass[static_cast<std::size_t>(i)]);
    model_.held.add_stiffness(h * h, diagonal_);
    rotations.resize(static_cast<std::size_t>(A.nodes()));
    if (device->assemble(moved(x), h * h + h * model_.damping_stiffness, diagonal_, force,
                         rotations)) {
      assembled_at_ = x;
      assembled_for_ = h;
      A.leave_there(*this);
      return;
    }
  }
  linearise_here(x, h, A, force);
  if (solver_.wants_rotations()) node_rotations(*model_.mesh, x, rotations);
}

void Assembly::find_force(const VecX& x, const NodePattern& pattern, VecX& force) {
  ConjugateGradientDevice* const device = device_for(pattern);
  if (device != nullptr && device->element_force(moved(x), force)) return;
  begin_here();
  force.setZero(x.size());
  model_.elastic->add_force(x, force);
}

void Assembly::restore(const VecX& x, Real h, NodeMatrix& A, std::vector<Mat3>& rotations) {
  if (ConjugateGradientDevice* const device = device_for(*A.pattern())) {
    diagonal_.setZero(x.size());
    if (device->assemble(moved(x), 1, diagonal_, unused_, rotations) &&
        device->set_matrix(view_of(A), model_.held.fixed())) {
      assembled_at_ = x;
      assembled_for_ = h;
      A.leave_there(*this);
      return;
    }
  }
  if (solver_.wants_rotations()) node_rotations(*model_.mesh, x, rotations);
}

void Assembly::bring(NodeMatrix& A) {
  if (solver_.device()->read_matrix(A.room())) return;
  linearise_here(assembled_at_, assembled_for_, A, unused_);  // the device has gone
}

}  // namespace sutura::tissue
