// Touches of a curve and a surface, of a solid outside of the channels that the curve has made.
#pragma once

#include "bulge.h"
#include "moving_curve.h"
#include "moving_surface.h"
#include "sutura/passage.h"
#include "touch.h"

namespace sutura::contact {

class CurveSurface : public Pair {
 public:
  /// `passage`: or null.
  CurveSurface(const SegmentedCurve& curve, std::shared_ptr<const Boundary> boundary,
               const Passage* passage)
      : curve_(curve), surface_(std::move(boundary)), passage_(passage) {}
  Real built_from(const Touch& touch) const override;
  Vec3 slip(const Touch& touch) const override;
  Real rolled(const Touch& touch) const override;
  void couple(const Touch& touch, BlockId block, const Directions& axes,
              ConstraintBuilder& builder) const override;
  void tell_force(const Touch& touch, const Vec3& force) override {
    surface_.boundary()->tell_force(-force, touch.at);
  }
  Real unseen_overlap() override;
  bool sees_left_overlap() const override { return true; }
  Real distance() const override;
  Tolerance tolerance(const Touch& touch) const override;

 protected:
  void look_for_touches(const TouchedPlaces& before, std::vector<Touch>& out) override;

 private:
  /// A point of the curve and the point of a triangle closest to it.
  struct Near {
    Index triangle = -1;
    Real u = 0;
    Vec3 weights = Vec3::Zero();
    Vec3 apart = Vec3::Zero();  ///< from the triangle to the curve (m)
    Real distance = 0;          ///< m
  };
  void look(bool standing);
  bool began_nearer(std::size_t segment, Real part) const;
  void hand_over(Passage::Stretch& stretch);
  void hand_over_ends();
  Real bulge(std::size_t segment) const;
  void doubt(std::size_t segment, const Box& box, Real motion, const Vec3& common);
  bool is_inside(Real low, Real high) const;
  void meet(std::size_t segment, const TouchedPlaces& before, std::vector<Touch>& out);
  Near closest(const CurveSegment& s, Index triangle, const Corners& at) const;
  static Near closest_to(const CurveSegment& s, Real u, Index triangle, const Corners& at);
  /// The points of the surface around a point that are closest to it among their neighbours, one
  /// for each side that it faces.
  void sides_of(std::size_t segment, Real u, std::vector<Near>& out);
  bool is_on(const Near& foot, Index triangle) const;
  void touch(std::size_t segment, const Near& near, std::vector<Touch>& out) const;

  const SegmentedCurve& curve_;
  MovingSurface surface_;
  ToolWay way_;  ///< of a tool
  const Passage* passage_;
  MovingCurve seen_;
  std::vector<Passage::Stretch> held_;    ///< in the channel
  std::vector<Passage::Stretch> inside_;  ///< and what is not yet clear of it
  std::vector<Index> around_;             ///< triangles that a segment may meet
  std::vector<Near> feet_, sides_;        ///< of a point of the curve
  Real overlap_at_start_ = 0;             ///< away from the mouths (m)
};

}  // namespace sutura::contact
