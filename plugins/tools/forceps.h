// Forceps: jaws with a shape that take what is between them, and hold it with a stated strength.
#pragma once

#include <vector>

#include "sutura/end_note.h"
#include "sutura/geometry/triangle_surface.h"
#include "sutura/simulation.h"
#include "timed_jaws.h"
#include "tool_space.h"

namespace sutura::tools {

class Forceps : public Component,
                public TimedJaws,
                public ConstraintSource,
                public ToolSpace,
                public Drawing,
                public EndNote {
 public:
  static void describe(Describe<Forceps>& d);

  void initialise(Setup& setup) override;
  void archive(Archive& archive) override;
  void drive(const StepContext& context) override;

  // ConstraintSource
  void detect(const StepContext& context) override;
  void build(const StepContext& context, ConstraintBuilder& builder) override;
  void commit(const StepContext& context, const SolvedBlocks& solved) override;
  const char* rows_attribute() const override { return "size"; }

  Wrench wrench() const override { return applied_; }

  BodyGeometry geometry() const override;
  std::string end_note() const override;

 private:
  /// What can be taken: one of the two is null.
  struct Target {
    SegmentedCurve* curve = nullptr;
    MeshedSolid* solid = nullptr;
    const Body& body() const {
      return curve != nullptr ? static_cast<const Body&>(*curve) : *solid;
    }
  };
  /// A point of the surface of what is held.
  struct Point {
    std::uint64_t id = 0;
    Real s = 0;          ///< of a curve: abscissa of its section
    Real side = 0;       ///< of a curve: 1 or -1, against which of the two jaws
    EmbeddedPoint at;    ///< of a solid
    Real part = 0;       ///< of strength and stiffness
    Real height = 0;     ///< over the middle between the jaws; of a curve, of its centreline (m)
    Vec2 stretch{0, 0};  ///< how far it is from where it would be without force, along the jaws (m)

    // Of one step.
    Vec3 start_arm = Vec3::Zero();  ///< of a curve: from the centre of its section (m)
    Vec3 arm = Vec3::Zero();        ///< the same material at the guess (m)
    Vec3 anchor = Vec3::Zero();     ///< where it would be without force, seen from the jaws (m)
    Vec3 gap = Vec3::Zero();        ///< from there, at the guess (m)
    BlockId along, across;
  };
  /// A strand of a thread or a patch of a tissue.
  struct Piece {
    Index target = 0;
    Vec3 place = Vec3::Zero();  ///< of a strand: its middle, seen from the jaws (m)
    Real share = 1;             ///< of strength and stiffness
    Real left = 1;              ///< part of what was taken that is still between the jaws
    bool slid = false;          ///< in the last step; needed only as that ends
    std::vector<Point> points;
  };

  void take();
  void take_strand(Index target, const JawSpace::Stretch& stretch);
  void take_patch(Index target);
  /// Strands that slide move on through the jaws: other material is between them now.
  void follow_strands();
  void drop_what_is_out();
  /// How flat closed jaws may press what they have taken without a force between strands.
  void find_flat();
  void begin_step(const Target& target, Real open, Point& p) const;
  /// Where a strand that was taken at `height` is brought while `open` of its way is left.
  Real drawn(Real height, Real open) const;
  Vec3 position(const Target& target, const Point& p) const;

  Link<Body> body_;
  Real strength_ = 10;
  Real stiffness_ = 1e6;

  Index source_id_ = 0;
  std::vector<Target> targets_;
  bool take_ = false;  ///< they have closed: what is between them is to be taken
  std::vector<Piece> pieces_;
  Real flat_ = 0;    ///< what closed jaws leave of the heights of strands over their mean
  Real middle_ = 0;  ///< mean of these heights when they were taken (m)
  std::uint64_t next_id_ = 0;
  bool sliding_ = false;
  Wrench applied_;  ///< on what is held, about the centre
};

}  // namespace sutura::tools
