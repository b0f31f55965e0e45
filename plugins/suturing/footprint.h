// The footprint of a needle tip on a tissue: the patch of surface that its force is spread over.
//
// A point load has no limit under refinement: the dent grows without bound as the elements shrink,
// and turns the one under the tip inside out. So the mesh carries the force on a disc of radius A,
// wide enough that the mean pressure stays a fraction of E up to the puncture: beyond that no
// linear law holds, and what happens closer to the tip is left to the threshold. The disc has a
// largest radius; what a tip does that presses harder than `bears` is not known. It dents a half
// space by 16 (1 - nu^2) F / (3 pi^2 A E) (mean dent under uniform pressure), whatever the mesh.
// Where the scene gives the tip a radius a of its own, the dent is that of a punch of this radius,
// (1 - nu^2) F / (2 a E) (Boussinesq): what the disc does not give is a compliance of the contact,
//   c = (1 - nu^2)/E (1/(2 a) - 16/(3 pi^2 A)).
#pragma once

#include <vector>

#include "sutura/constraints.h"

namespace sutura::suturing {

class Footprint {
 public:
  /// Makes room for its points, so that nothing is allocated in a step.
  Footprint();
  /// On `surface`, at the start of a step, for a force of at most `force` (N). tip_radius 0: that
  /// of the disc.
  void find(const SolidBody& tissue, const SurfacePoint& surface, Real tip_radius,
            Real shaft_radius, Real force);
  /// A single point, without compliance.
  void find(const SurfacePoint& surface);
  /// After `find`, where the tip presses already: the point under the tip is there (m, at the start
  /// of the step), so that the gap goes on where it was although the tissue has bent.
  void put_under(const Vec3& tip, const SolidBody& tissue);

  void archive(Archive& archive);

  Real compliance() const { return compliance_; }  ///< c, m/N
  /// The largest force of which it is known what it does (N).
  Real bears() const { return bears_; }
  /// Where the point under the tip is now: carried along by the mean motion of the footprint.
  Vec3 position(const SolidBody& tissue, Configuration c) const;
  /// Mean outward unit normal.
  Vec3 normal(const SolidBody& tissue, Configuration c) const;
  /// Couples a block whose delta grows by directions * motion of the footprint.
  void couple(ConstraintBuilder& builder, BlockId block, const SolidBody& tissue,
              const Mat3& directions, const Vec3& at) const;

 private:
  std::vector<SurfacePoint> points_;  ///< of equal weight
  Vec3 offset_ = Vec3::Zero();        ///< from their mean to the point under the tip
  Real compliance_ = 0;
  Real bears_ = 0;
};

}  // namespace sutura::suturing
