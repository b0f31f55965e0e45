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
  struct Pressing {
    Real tip_radius = 0;    ///< 0: that of the disc
    Real shaft_radius = 0;  ///< m
    Real force = 0;         ///< at most (N)
  };
  /// On `surface`, at the start of a step. Points are laid out over the tissue as it is then, or as
  /// it is at rest: under a tent a disc has no other shape.
  void find(const SolidBody& tissue, const SurfacePoint& surface, const Pressing& tip,
            Configuration shape);
  /// A single point, without compliance.
  void find(const SurfacePoint& surface);
  /// A tip that presses has slid `from` one point of the surface `to` another: the footprint slides
  /// along in the tissue. The point under the tip is `under` it now (m, at the start of the step),
  /// and as high over the mean of the footprint as before: how deep the tip has got depends on
  /// where it is, not on the way that it took.
  void slide(const SolidBody& tissue, const SurfacePoint& from, const SurfacePoint& to,
             const Vec3& under, const Pressing& tip);

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
  void fit(const SolidBody& tissue, const SurfacePoint& surface, const Pressing& tip);

  std::vector<SurfacePoint> points_;  ///< of equal weight
  Vec3 offset_ = Vec3::Zero();        ///< from their mean to the point under the tip
  Real disc_ = 0;                     ///< its radius (m)
  Real compliance_ = 0;
  Real bears_ = 0;
};

}  // namespace sutura::suturing
