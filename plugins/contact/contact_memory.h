// Contacts from pass to pass and from step to step: who is who, and what sticking has missed.
#pragma once

#include <vector>

#include "touch.h"

namespace sutura {
class Archive;
}

namespace sutura::contact {

class ContactMemory {
 public:
  /// Gives every touch its id: that of the nearest one known, from the step before or from a pass
  /// of this one, or a new one. `first_pass`: what passes of a step before have met is forgotten.
  void recognise(std::vector<Touch>& touches, const Pair& pair, bool first_pass);
  /// What the step ends with. Of one that slipped or let go, `left_over` is nothing.
  void remember(const std::vector<Touch>& touches);
  void archive(Archive& archive);

 private:
  struct Known {
    std::uint64_t id = 0;
    Real first = 0, second = 0;
    Vec2 left_over = Vec2::Zero();
  };
  std::vector<Known> known_, met_;  ///< at the start of the step; in its passes
  std::vector<char> taken_;
  std::uint64_t next_id_ = 0;
};

}  // namespace sutura::contact
