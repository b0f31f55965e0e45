// Component PathFriction: dry and viscous friction of needle and thread in their channel (paper,
// section 4.5).
#pragma once

#include <vector>

#include "path_friction_law.h"
#include "suture_path.h"

namespace sutura::suturing {

class PathFriction : public Component, public ConstraintSource {
 public:
  static constexpr const char* interface_name = "PathFriction";
  static void describe(Describe<PathFriction>& d);
  void initialise(Setup& setup) override;
  void archive(Archive& archive) override;
  void build(const StepContext& context, ConstraintBuilder& builder) override;
  bool revise(const StepContext& context, const SolvedBlocks& solved) override;
  void commit(const StepContext& context, const SolvedBlocks& solved) override;
  std::string fault() const override;

  /// Kinetic resistance per length of the needle at this point of the tissue, without lateral force
  /// (N/m).
  Real needle_resistance(const EmbeddedPoint& at) const;

 private:
  enum class ThreadMaterial { as_needle, monofilament, braided };
  enum class PressureFrom { value, tissue };
  Real thread_coefficient() const;
  Real pressure(const EmbeddedPoint& at) const;
  Real mean_pressure(const Crossing& c) const;
  Real pressure_along(const EmbeddedPoint& from, const EmbeddedPoint& to, Real part) const;
  Real pressure_to_tip(const PathSample& sample, const EmbeddedPoint& ahead, Real length) const;
  Link<SuturePath> path_;
  Real coefficient_ = 0.2;
  Real static_coefficient_ = 0;
  Real static_over_kinetic_ = 1;
  ThreadMaterial thread_material_ = ThreadMaterial::as_needle;
  Real pressure_ = 10e3;
  PressureFrom pressure_from_ = PressureFrom::value;
  Real lateral_share_ = 0;
  Real viscosity_ = 0;
  Real stick_speed_ = 0;
  Index source_id_ = 0;
  std::vector<Real> pressures_;  ///< per crossing, of this step (Pa)
  struct SampleBlock {
    BlockId block;
    std::uint64_t sample;
    PathFrictionLaw::Params params;
  };
  bool slides(const SolvedBlocks& solved, const SampleBlock& block) const;
  std::vector<SampleBlock> blocks_;  ///< per crossing
  int revisions_ = 0;                ///< of this step, or of the present part of it
  Real lacks_ = 0;  ///< by what share it lags behind what presses, after all of these
  /// Slip that the last step left at samples that stick, by rounding and within the tolerance: the
  /// next one takes it back, or a thread at rest would creep.
  struct Left {
    std::uint64_t sample = 0;
    Real slip = 0;  ///< m
  };
  std::vector<Left> left_;  ///< in the order of passage
  Real left_at(std::uint64_t sample) const;
  Real force_ =
      0;  ///< sum of axial forces on the thread, positive towards the end of the thread (N)
  Real limit_ = 0;  ///< sum of kinetic resistances (N)
  Index sliding_ = 0;
};

}  // namespace sutura::suturing
