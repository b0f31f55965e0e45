// Contacts from pass to pass and from step to step: who is who, and what sticking has missed.
#pragma once

#include <compare>
#include <vector>

#include "touch.h"

namespace sutura {
class Archive;
}

namespace sutura::contact {

class ContactMemory : public TouchedPlaces {
 public:
  /// `lambda`, `mode`: as the step begins.
  struct Known {
    std::uint64_t id = 0;
    Real first = 0, second = 0;
    Vec2 left_over = Vec2::Zero();
    Vec3 lambda = Vec3::Zero();
    Mode mode = 0;
    bool rests = false;  ///< within a rigid body
  };

  void begin_step() { met_ = known_; }
  Real between(Real low, Real high) const override;
  /// Gives every touch its id: that of the nearest one known, from the step before or from a pass
  /// of this one, or a new one.
  void recognise(std::vector<Touch>& touches, const Pair& pair);
  /// Those known that were not recognised last time: visit(known).
  template <class Visit>
  void each_missing(const Visit& visit) const {
    for (std::size_t i = 0; i < taken_.size(); ++i)
      if (!taken_[i]) visit(places_[i]);
  }
  /// What the step ends with: those that carry force, and those that rest within a rigid body. Of
  /// one that slipped `left_over` is nothing.
  void remember(const std::vector<Touch>& touches, const Pair& pair);
  void archive(Archive& archive);

 private:
  static void sort(std::vector<Known>& all);
  std::vector<Known> known_, met_;  ///< at the start of the step; in its passes
  struct Match {
    Real off = 0;  ///< m
    std::size_t touch = 0, known = 0;
    auto operator<=>(const Match&) const = default;
  };
  std::vector<Match> matches_;
  std::vector<char> taken_;         ///< per known
  std::vector<std::size_t> found_;  ///< per touch: which known it is
  std::vector<Known> places_;       ///< what becomes of `met_`
  std::uint64_t next_id_ = 0;
};

}  // namespace sutura::contact
