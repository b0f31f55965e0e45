// Walls of a tissue that have gone into each other, where no Contact keeps them apart.
#pragma once

#include <string>

#include "solid_queries.h"
#include "sutura/archive.h"

namespace sutura::tissue {

class SelfOverlap {
 public:
  /// After a step. Looks at every tenth, which costs a few percent of one.
  void look(const SolidQueries& now, Real edge_length, Real time);
  /// What was seen, if it was more than a tenth of an edge, from where on a Contact calls an
  /// overlap a fault; else empty.
  std::string sentence(Real edge_length) const;
  void archive(Archive& a);

 private:
  Index steps_ = 0;
  Real deepest_ = 0, time_ = 0;  ///< m, s
  Vec3 place_ = Vec3::Zero();    ///< m
};

}  // namespace sutura::tissue
