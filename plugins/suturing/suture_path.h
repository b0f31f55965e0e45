// Component SuturePath: keeps needle and thread inside the channel they have made (paper,
// section 4.4).
#pragma once

#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "channel.h"
#include "sutura/constraints.h"
#include "sutura/describe.h"
#include "sutura/passage.h"

namespace sutura::suturing {

/// Where the thread crosses one sample of the channel in this step. Made in `detect`, used by every
/// source on the path.
struct Crossing {
  std::size_t sample = 0;  ///< index into Channel::samples
  std::uint64_t id = 0;    ///< of the sample; the end of the channel has an id of its own
  Real abscissa = 0;       ///< of the section at the sample (m)
  Channel::Share share;    ///< of the thread
  Vec3 position = Vec3::Zero();
  Mat3 axes = Mat3::Identity();  ///< rows: tangent (towards growing abscissa), two normals
  /// Thread point minus tissue point along `axes` (m). The axial one is the slip of the step: it is
  /// counted from the section that was at the sample when the step began.
  Vec3 gap = Vec3::Zero();
  PointJacobian thread;
  PointJacobian tissue;
};

class SuturePath : public Component, public ConstraintSource, public Passage {
 public:
  static constexpr const char* interface_name = "SuturePath";
  static void describe(Describe<SuturePath>& d);
  void initialise(Setup& setup) override;
  void ready(Setup& setup) override;
  void archive(Archive& archive) override;
  void detect(const StepContext& context) override;
  void build(const StepContext& context, ConstraintBuilder& builder) override;
  void commit(const StepContext& context, const SolvedBlocks& solved) override;
  std::string fault() const override;
  const char* rows_attribute() const override { return "spacing"; }

  const CurveBody& curve() const override { return *thread_; }
  const SolidBody& solid() const override { return *tissue_; }
  void inside(std::vector<Stretch>& out) const override;

  const CurveBody& thread() const { return *thread_; }
  const SolidBody& tissue() const { return *tissue_; }
  Channel& channel() { return *channel_; }
  const Channel& channel() const { return *channel_; }
  /// One per sample on the thread, in the order of passage; none before this step's `detect`.
  std::span<const Crossing> crossings() const { return {crossings_.data(), sample_crossings_}; }
  Real spacing() const { return spacing_; }
  /// Finds what the thread presses on the wall by the solved guess, for each of the crossings.
  void find_pressing(const SolvedBlocks& solved);
  Real pressing(std::size_t crossing) const { return pressing_[crossing].norm(); }  ///< N
  /// Friction goes by what was found last, from now on.
  void keep_pressing();
  /// Of each kind of law one acts on a path. Complains of a second one.
  void add_law(const Component& law, Setup& setup) {
    const std::string& kind = law.info().name;
    if (!laws_.insert(kind).second)
      setup.error(law, "a second " + kind + " on this path: the forces of both would add up");
  }
  /// What holds the tip from the inside: a surface or a layer. Through it the puncture law decides.
  struct Block {
    Vec3 normal;  ///< unit, on the side where the tip is
    Key key;      ///< of the rows that hold it
  };
  void set_tip_blocked(const std::optional<Block>& by) { blocked_by_ = by; }
  bool tip_blocked() const { return blocked_by_.has_value(); }
  /// A surface has given way to the tip from the inside, at the last guess.
  void set_tip_let_out(bool out) { tip_let_out_ = out; }
  /// The unit vector along what holds the tip in which the needle leads it there: that way lies
  /// tissue that is to be cut. Zero where it leads straight at it, or has gone through.
  Vec3 way_along_block(const ConstraintBuilder& builder) const;

 private:
  /// As the step began: `before`, the abscissa, and `across`, a unit vector across the thread. Now
  /// the abscissa is between `low` and `high`.
  Crossing cross(const EmbeddedPoint& at, std::uint64_t id, Real before, const Vec3& across,
                 Real low, Real high) const;

  Link<CurveBody> thread_;
  Link<SolidBody> tissue_;
  Real spacing_ = 1e-3;
  Real wall_compliance_ = 1e-7;
  Real strength_ = 0;  ///< N/m; 0: without limit
  bool sewn_ = false;
  Index source_id_ = 0;
  std::set<std::string> laws_;  ///< names of the components that act on it
  std::optional<Channel> channel_;
  std::vector<Crossing>
      crossings_;  ///< samples on the thread, then the end of the channel if the tip is there
  std::size_t sample_crossings_ = 0;
  struct LateralBlock {
    BlockId block;
    std::size_t crossing;
    Real compliance;  ///< of the wall, m/N
    Real length;      ///< of channel that it bears for (m)
  };
  void sew(Setup& setup);
  Vec3 known_force(const Crossing& c, const ConstraintBuilder& builder) const;
  void add_turning_force(const StepContext& context, const Crossing& c, const Vec3& force,
                         ConstraintBuilder& builder) const;
  bool is_at_tip(const Crossing& c) const;
  Real share_of_end() const;
  Real stray() const;
  Vec3 turned_by_tension(const Crossing& c) const;
  void cut(const SolvedBlocks& solved);
  std::vector<LateralBlock> blocks_;
  std::vector<Vec3> pressing_;  ///< per sample, of the last solved guess (N)
  std::optional<Block> blocked_by_;
  bool tip_let_out_ = false;
  Vec3 way_along_ = Vec3::Zero();  ///< way_along_block at the last guess
  Real lateral_force_ = 0;         ///< largest over the samples (N)
  Real lateral_gap_ = 0;           ///< largest distance thread - channel (m)
  Real stray_ = 0;  ///< of a blocked tip from the end of its channel, in the last step (m)
  Real cut_ = 0;    ///< area that the thread has cut through (m^2)
};

}  // namespace sutura::suturing
