// The constraint forces of one step as a cloud of points that can be drawn as arrows.
#pragma once

#include <string>
#include <vector>

#include "sutura/constraints.h"
#include "vtu.h"

namespace sutura::output {

/// Numbers laws in the order in which they first appear, for a whole run.
class LawNumbers {
 public:
  int number(const std::string& law);
  /// ("law 0 is path", 0), ...
  std::vector<std::pair<std::string, int>> legend() const;

  void archive(Archive& archive);

 private:
  std::vector<std::string> names_;
};

/// One vertex per block, where the block acts. Fields: "force [N]" on the first body of the block,
/// "lambda [N]" and "delta [m]" (norms over the rows of the block), "mode", "law". Without blocks:
/// one vertex at the origin with zero force and law -1.
VtuGrid constraint_grid(const ConstraintProblem& problem, LawNumbers& laws);

}  // namespace sutura::output
