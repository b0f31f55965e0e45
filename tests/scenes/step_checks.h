// What must hold in every step of every scene, judged from the definition of each law and from the
// geometry of the bodies, not from the residual of the solver.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sutura/constraints.h"
#include "sutura/simulation.h"

namespace sutura::testing {

/// Newton's third law. Every block pushes two bodies with opposite forces, along lines that are
/// apart by the gap between the two points it couples: the moments about any point add up to gap x
/// force.
struct ThirdLaw {
  Real force = 0;   ///< |sum of f| / sum |f| over all nodes of all bodies
  Real moment = 0;  ///< |sum of moments - sum of gap x f| / sum |x| |f|, gaps from the geometry of
                    ///< thread and tissue
  Real off_curve = 0;  ///< largest distance of a point on which path rows act from the centreline
                       ///< of the thread (m)
  Real gap = 0;  ///< largest distance between the two points of a path block that bears a force (m)
};
/// The bodies are where the rows of the problem were built.
ThirdLaw third_law(const Simulation& simulation, const ConstraintProblem& solved);

/// What a tolerance on lengths means for the force of a block: that force over which the bodies
/// give way by so much there.
class ForceTolerance {
 public:
  /// `solved`: with the compliance of the last pass. A block that is not in it counts with the
  /// compliance that its units make.
  ForceTolerance(const ConstraintProblem& solved, Real length);
  /// `drag`: force per slip of the law (N/m), so that a slip that is off is a force that is off.
  Real of(const ConstraintBlock& block, Real drag = 0) const;

 private:
  Real length_;
  std::map<Key, Real> softness_;  ///< least compliance in any direction, m/N
};

/// The largest amount by which a force lies outside the set that its law admits, over the blocks,
/// as a multiple of its tolerance; `who` names the worst.
Real outside_admissible(const ConstraintProblem& end, const ForceTolerance& tolerance,
                        std::string& who);
/// The largest distance from the graph of the laws: how far delta is from what the state of the
/// force asks for, in m. A force counts as inside its limits if it is so by its tolerance.
Real off_graph(const ConstraintProblem& end, const ForceTolerance& tolerance, std::string& who);

/// Surfaces and layers that gave way in this solve.
struct PunctureCount {
  Index entries = 0, layers = 0, exits = 0;
};
PunctureCount punctures(const ConstraintProblem& start, const ConstraintProblem& solved);

}  // namespace sutura::testing
