#include "contact_memory.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sutura/archive.h"

namespace sutura::contact {

Real ContactMemory::between(Real low, Real high) const {
  const auto it = std::upper_bound(met_.begin(), met_.end(), low,
                                   [](Real place, const Known& k) { return place < k.first; });
  return it != met_.end() && it->first < high ? it->first : std::numeric_limits<Real>::quiet_NaN();
}

/// Those that are nearest to each other are the same: the order of touches must not matter, else
/// one that is new takes the name of another that is still there. `met_` is sorted by the first
/// place: only those within the tolerance are compared.
void ContactMemory::recognise(std::vector<Touch>& touches, const Pair& pair) {
  const std::size_t known = met_.size();
  matches_.clear();
  for (std::size_t i = 0; i < touches.size(); ++i) {
    const Touch& t = touches[i];
    const Pair::Tolerance near = pair.tolerance(t);
    const auto it = std::lower_bound(met_.begin(), met_.end(), t.first_place - near.first,
                                     [](const Known& k, Real place) { return k.first < place; });
    for (auto k = static_cast<std::size_t>(it - met_.begin());
         k < known && met_[k].first <= t.first_place + near.first; ++k) {
      const Real second = std::abs(met_[k].second - t.second_place);
      if (second <= near.second)
        matches_.push_back({std::abs(met_[k].first - t.first_place) + second, i, k});
    }
  }
  std::sort(matches_.begin(), matches_.end());
  taken_.assign(known, 0);
  found_.assign(touches.size(), known);
  for (const Match& m : matches_)
    if (!taken_[m.known] && found_[m.touch] == known)
      taken_[m.known] = 1, found_[m.touch] = m.known;
  places_.clear();
  for (std::size_t i = 0; i < touches.size(); ++i) {
    Touch& t = touches[i];
    Known now{.first = t.first_place, .second = t.second_place};
    if (found_[i] < known) {
      const Known& same = met_[found_[i]];
      t.id = same.id;
      t.left_over = same.left_over;
      t.pressed = same.lambda[0];
      if (same.rests) t.lambda = same.lambda, t.mode = same.mode;
      now.lambda = same.lambda, now.mode = same.mode, now.rests = same.rests;
    } else {
      t.id = next_id_++;
    }
    now.id = t.id, now.left_over = t.left_over;
    places_.push_back(now);
  }
  // Where they are now, and those that were not found this time where they were.
  for (std::size_t i = 0; i < known; ++i)
    if (!taken_[i]) places_.push_back(met_[i]);
  met_.swap(places_);
  sort(met_);
}

void ContactMemory::sort(std::vector<Known>& all) {
  std::sort(all.begin(), all.end(), [](const Known& a, const Known& b) {
    return a.first != b.first ? a.first < b.first : a.id < b.id;
  });
}

void ContactMemory::remember(const std::vector<Touch>& touches, const Pair& pair) {
  std::erase_if(known_, [&pair](const Known& k) { return !pair.are_one(k.first, k.second); });
  for (Known& k : known_) k.rests = true;
  for (const Touch& t : touches)
    if (t.carries)
      known_.push_back({t.id, t.first_place, t.second_place, t.left_over, t.lambda, t.mode});
  sort(known_);
}

void ContactMemory::archive(Archive& a) {
  a.list("known", known_, [](Archive& each, Known& k) {
    each("id", k.id);
    each("first", k.first);
    each("second", k.second);
    each("left_over", k.left_over);
    each("lambda", k.lambda);
    each("mode", k.mode);
    each("rests", k.rests);
  });
  a("next_id", next_id_);
}

}  // namespace sutura::contact
