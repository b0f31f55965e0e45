// Component Puncture: the tip presses on a tissue until the force threshold lets it through (paper,
// section 4.2).
#pragma once

#include <array>
#include <optional>

#include "cutting.h"
#include "footprint.h"
#include "path_friction.h"
#include "region_thresholds.h"
#include "suture_path.h"

namespace sutura::suturing {

class Puncture : public Component, public ConstraintSource, private RegionThresholds {
  friend class RegionThresholds;  // describes its own attributes

 public:
  static constexpr const char* interface_name = "Puncture";
  static void describe(Describe<Puncture>& d);
  void initialise(Setup& setup) override;
  void ready(Setup& setup) override;
  void archive(Archive& archive) override;
  void detect(const StepContext& context) override;
  void build(const StepContext& context, ConstraintBuilder& builder) override;
  void commit(const StepContext& context, const SolvedBlocks& solved) override;
  std::string fault() const override;

 private:
  /// A tip that is no deeper than this lies on the surface (in units of `reach`).
  static constexpr Real still_outside = 1e-3;

  /// What the tip faces: a surface from outside, a layer from inside the one above it, a surface
  /// from inside; or nothing, because it got in without a puncture.
  enum class Front { none, entry, layer, exit, overrun };
  void find_front();
  void search_front();
  void lay_footprint();
  void lay(Footprint& footprint, Front front, const SurfacePoint& touched) const;
  Footprint::Pressing pressing(Front front, const SurfacePoint& touched) const;
  bool keeps_place();
  bool is_free(Real above);
  Real overlap() const;
  bool is_past_edge(const Vec3& normal, Real apart) const;
  Front find_entry();
  bool is_inside() const;
  bool meet_on_the_way();
  bool is_beyond(const SurfacePoint& hit) const;
  bool is_beside(Real reach) const;
  Front find_exit();
  bool find_layer(Real reach);
  /// Of the tip, in the step so far (m).
  Real motion() const;
  void find_walls_behind(bool anew);
  void commit_front(const SolvedBlocks& solved);
  void commit_walls_behind(const SolvedBlocks& solved);
  void go_through(Front front, const SurfacePoint& touched, bool goes_on);
  bool goes_through_wall(const SolvedBlocks& solved, std::size_t wall) const;
  void begin_bite(const SurfacePoint& touched, bool goes_on);
  void follow(Front front, const Footprint& footprint, SurfacePoint& touched) const;
  BlockId add_block(ConstraintBuilder& builder, Front front, const Footprint& footprint,
                    const SurfacePoint& touched, Index count) const;
  Key key_of(Front front, Index count) const;
  Real threshold_at(Front front, const SurfacePoint& touched) const;

  Link<SuturePath> path_;
  Link<Cutting> cutting_;
  Link<PathFriction> drag_;
  Real threshold_ = 0.5;
  Real exit_threshold_ = 0;
  Real friction_ = 0.2;
  Real tip_radius_ = 0;  ///< 0: that of the footprint
  Real reach_ = 1e-3;
  Index source_id_ = 0;

  Front front_ = Front::none;
  bool blocked_ = false;  ///< the front holds the tip from the inside
  Footprint footprint_;
  /// So far behind the surface the tip has been found, before it pressed there: tissue has sprung
  /// back past it. Pushed out at once it would press harder the shorter the step is (m).
  Real left_ = 0;
  bool presses_ = false;       ///< it has a place where it presses, on entry or exit
  Front place_ = Front::none;  ///< which of the two
  bool lifted_ = false;        ///< but it bore no force in the last step
  SurfacePoint touched_;       ///< normal: out of what the tip would go into
  /// A surface behind the front, so near that the tip may get there in the step in which it goes
  /// through the front: the far side of what it goes into, or the next wall of the same tissue.
  struct Wall {
    Front front = Front::none;  ///< entry or exit, in turn
    SurfacePoint touched;
    Footprint footprint;
    BlockId block;
  };
  static constexpr std::size_t most_walls = 3;  ///< a front and they: two plates, in and out
  std::array<Wall, most_walls> behind_;         ///< in the order in which the tip would meet them
  std::size_t walls_behind_ = 0;
  Real sought_ = 0;  ///< for a motion of the tip of so much (m)
  int region_ = 0;   ///< of the layer the tip has got into
  BlockId block_;
  Real threshold_here_ = 0;  ///< of the front (N)
  Index count_ = 0;          ///< punctures so far
  Index overruns_ = 0;
  bool let_out_ = false;    ///< through the surface in the last step
  bool got_out_ = false;    ///< in the last step, without a puncture
  bool passed_by_ = false;  ///< a whole wall, in the last step, without a puncture
  bool overloads_ = false;  ///< what it presses on, in the last step
  Real force_ = 0;          ///< along the normal (N)
  Real peak_force_ = 0;     ///< largest so far (N)
};

}  // namespace sutura::suturing
