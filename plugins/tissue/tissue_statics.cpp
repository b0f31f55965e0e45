#include "tissue_statics.h"

#include <cmath>
#include <limits>

#include "node_rotations.h"
#include "sutura/units.h"
#include "tissue_solver.h"

namespace sutura::tissue {
namespace {

/// Forces that a shape is under (N), with A <- their stiffness. `outside`: weight and loads.
VecX linearise(TissueModel& model, const VecX& outside, const VecX& x, NodeMatrix& A) {
  VecX force = outside;
  A.set_zero();
  model.elastic->linearise(x, 1, A, force);
  model.held.add_stiffness(1, A);
  for (const FollowerLoad* follower : model.followers) follower->add_stiffness(x, 1, A);
  model.held.add_force(x, force);
  model.held.clear_fixed(force);
  return force;
}

}  // namespace

/// Newton on the potential of elasticity, supports, weight and loads, each step shortened until the
/// potential falls. Loads that follow the surface have no potential in general, and count there as
/// they are where the step begins. With a solver of its own: the one of the steps may be late by
/// some of them.
std::string settle(TissueModel& model, VecX& load, const Vec3& gravity, VecX& x) {
  VecX weight(model.dofs());
  for (Index i = 0; i < model.dofs(); i += 3)
    weight.segment<3>(i) = model.mass[static_cast<std::size_t>(i / 3)] * gravity;
  VecX outside = weight + load;
  model.held.put(x);
  model.elastic->set_viscosity(x, 0);
  const auto potential = [&](const VecX& at) {
    return model.elastic->energy(at) - outside.dot(at - model.rest) + model.held.energy(at);
  };
  NodeMatrix A(model.dofs() / 3, model.elastic->pairs());
  const auto direct = make_direct_solver();
  direct->analyse(A.pattern(), model.held.fixed(), {});
  std::vector<Mat3> rotations;
  // Newton halves what is missing in a few steps, or in a few more where the tissue buckles on the
  // way. Under a load that has no balance it would go on for ever.
  constexpr Index most = 200, patience = 30;
  // A millionth of what acts, or nothing left to move: the forces of stiff supports never add up to
  // less than their rounding.
  const Real smallest = 1e-9 * model.edge_length;
  VecX next_x;
  Real left = 0, half = std::numeric_limits<Real>::infinity();
  Index halved = 0;  // the last step in which it was
  for (Index i = 0; i < most; ++i) {
    for (FollowerLoad* follower : model.followers) follower->follow(x, load);
    outside = weight + load;
    VecX step = linearise(model, outside, x, A);
    left = step.norm();
    if (left <= 1e-6 * outside.norm()) return {};
    if (left < half) {
      half = left / 2;
      halved = i;
    }
    if (i - halved > patience || !std::isfinite(left)) break;
    node_rotations(*model.mesh, x, rotations);
    direct->prepare(A, rotations, i);
    direct->solve(step);
    const Real longest = step.lpNorm<Eigen::Infinity>();
    if (longest <= smallest && direct->report().converged) return {};
    Real part = 1;
    const Real value = potential(x);
    for (int cut = 0; cut < 30; ++cut, part /= 2) {
      next_x = x + part * step;
      // The last steps change the potential by less than its rounding.
      if (potential(next_x) < value || part * longest <= 1e-6 * model.edge_length) break;
    }
    x = next_x;
  }
  return "no balance was found, " + format_real(left) + " N of " + format_real(outside.norm()) +
         " N are left";
}

}  // namespace sutura::tissue
