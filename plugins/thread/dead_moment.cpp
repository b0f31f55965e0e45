#include "dead_moment.h"

namespace sutura::thread {

bool DeadMoments::find(const Rod& rod, const Dofs& load) {
  spins_.clear();
  for (Index i = 0; i < rod.nodes() && rod.stretches().empty(); ++i) {
    const Index spin = 6 * i + 3;
    if (!load.segment<3>(spin).isZero(0) && !rod.is_clamped(i)) spins_.push_back(spin);
  }
  return !spins_.empty();
}

void DeadMoments::begin(const Rod& rod, const Dofs& load, Real scale) {
  const Index size = 3 * static_cast<Index>(spins_.size());
  columns_.setZero(rod.dofs(), size);
  turning_.setZero(size, size);
  Index k = 0;
  for (const Index spin : spins_) {
    columns_.block<3, 3>(spin, k).setIdentity();
    turning_.block<3, 3>(k, k) = -scale / 2 * cross_matrix(Vec3(load.segment<3>(spin)));
    k += 3;
  }
}

void DeadMoments::finish(Eigen::Ref<VecX> answer) {
  const Index size = turning_.rows();
  own_.resize(size, size);
  spun_.resize(size);
  Index k = 0;
  for (const Index spin : spins_) {
    own_.middleRows<3>(k) = columns_.middleRows<3>(spin);
    spun_.segment<3>(k) = answer.segment<3>(spin);
    k += 3;
  }
  both_.setIdentity(size, size);
  both_.noalias() += own_ * turning_;
  lu_.compute(both_);
  due_ = lu_.solve(spun_);
  spun_.noalias() = turning_ * due_;
  answer.noalias() -= columns_ * spun_;
}

}  // namespace sutura::thread
