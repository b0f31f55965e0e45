#include "best_guess.h"

#include <algorithm>
#include <cmath>

namespace sutura {

BestGuess::BestGuess(const Bodies& bodies) : bodies_(bodies) {
  for (const auto& b : bodies_) motion_.push_back(VecX::Zero(b.body->dofs()));
}

bool BestGuess::look(const std::vector<Imbalance>& imbalance, bool reached) {
  Real lacks = 0;
  for (const Imbalance& i : imbalance) {
    if (!std::isfinite(i.force)) return false;
    lacks = std::max(lacks, i.force);
  }
  if (least_ >= 0 && !(lacks < least_)) return false;
  least_ = lacks;
  for (std::size_t i = 0; i < bodies_.size(); ++i) bodies_[i].body->motion(motion_[i]);
  reached_ = reached;
  return true;
}

bool BestGuess::go_back(const StepContext& context) const {
  if (least_ < 0) return false;
  for (std::size_t i = 0; i < bodies_.size(); ++i) bodies_[i].body->move_to(context, motion_[i]);
  return true;
}

}  // namespace sutura
