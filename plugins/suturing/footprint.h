// The footprint of a needle tip on a tissue: the patch of surface that its force is spread over.
//
// A point load has no limit under refinement: the dent grows without bound as the elements shrink,
// and turns the one under the tip inside out. A tip of radius a dents a half space by (1 - nu^2) F
// / (2 a E) (flat punch, Boussinesq), at a strain that no linear law bears. So the mesh carries the
// force on a disc of radius A, wide enough that the mean pressure stays a fraction of E up to the
// puncture, and the rest of the dent, of the field close to the tip, is a compliance of the contact
// itself:
//   c = (1 - nu^2)/E (1/(2 a) - 16/(3 pi^2 A))
// (the second term: mean dent of a disc under uniform pressure). Their sum does not depend on A,
// nor on the mesh.
#pragma once

#include <vector>

#include "sutura/constraints.h"

namespace sutura {

class Footprint {
 public:
  /// On `surface`, for a tip of this radius and a force of at most `force` (N). Found at the start
  /// of a step.
  void find(const SolidBody& tissue, const SurfacePoint& surface, Real tip_radius, Real force);
  /// A single point, without compliance.
  void find(const SurfacePoint& surface);

  /// What is left of a step: its compliance. The points are found anew in the next one.
  void archive(Archive& archive);

  Real compliance() const { return compliance_; }  ///< c, m/N
  /// Where the point under the tip is now: carried along by the mean motion of the footprint.
  Vec3 position(const SolidBody& tissue) const;
  /// Mean outward unit normal now.
  Vec3 normal(const SolidBody& tissue) const;
  /// Couples a block whose delta grows by directions * motion of the footprint.
  void couple(ConstraintBuilder& builder, BlockId block, const SolidBody& tissue,
              const Mat3& directions, const Vec3& at) const;

 private:
  std::vector<SurfacePoint> points_;  ///< of equal weight
  Vec3 offset_ = Vec3::Zero();        ///< from their mean to the point under the tip
  Real compliance_ = 0;
};

}  // namespace sutura
