// Moments that keep their direction, which have no potential.
//
// As a section under such a moment m spins by s, what is missing of balance there changes by
// m x s / 2 besides what the Hessian of the energy says (the derivative of a moment by a spin is
// symmetric only up to half of the moment itself; Simo and Vu-Quoc 1986). A symmetric matrix A
// cannot have that term. Left out, passes swing instead of contracting, and a bent thread trembles
// out of its plane for ever.
#pragma once

#include <Eigen/LU>

#include "rod.h"

namespace sutura::thread {

class DeadMoments {
 public:
  /// `answer` is A^-1 of something and becomes (A + N)^-1 of it, where N is -`scale` [m]x / 2 at
  /// the spins of every node with a moment m in `load` (N m; by Woodbury's formula). `solve` turns
  /// columns into A^-1 of them. Clamped nodes do not spin, and followers of rigid stretches have
  /// no answer of their own: where there are some, nothing is done.
  template <class Solve>
  void turn(const Rod& rod, const Dofs& load, Real scale, const Solve& solve,
            Eigen::Ref<VecX> answer) {
    if (!find(rod, load)) return;
    begin(rod, load, scale);
    solve(columns_);
    finish(answer);
  }

 private:
  bool find(const Rod& rod, const Dofs& load);
  void begin(const Rod& rod, const Dofs& load, Real scale);
  void finish(Eigen::Ref<VecX> answer);

  std::vector<Index> spins_;  ///< first dof of the spin of each node with a moment
  MatX columns_, turning_;    ///< A^-1 of unit moments there, and N
  // Memory of `finish`: nothing is allocated once there are as many moments as there will be.
  MatX own_, both_;
  VecX spun_, due_;
  Eigen::PartialPivLU<MatX> lu_;
};

}  // namespace sutura::thread
