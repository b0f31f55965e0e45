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

/// `met_` is sorted by the first place: only those within the tolerance are compared.
void ContactMemory::recognise(std::vector<Touch>& touches, const Pair& pair) {
  taken_.assign(met_.size(), 0);
  places_.clear();
  const std::size_t known = met_.size();
  for (Touch& t : touches) {
    const Pair::Tolerance near = pair.tolerance(t);
    auto it = std::lower_bound(met_.begin(), met_.end(), t.first_place - near.first,
                               [](const Known& k, Real place) { return k.first < place; });
    std::size_t best = known;
    Real least = std::numeric_limits<Real>::infinity();
    for (auto i = static_cast<std::size_t>(it - met_.begin());
         i < known && met_[i].first <= t.first_place + near.first; ++i) {
      const Real second = std::abs(met_[i].second - t.second_place);
      if (taken_[i] || second > near.second) continue;
      const Real off = std::abs(met_[i].first - t.first_place) + second;
      if (off < least) least = off, best = i;
    }
    if (best < known) {
      taken_[best] = 1;
      t.id = met_[best].id;
      t.left_over = met_[best].left_over;
      if (met_[best].rests) t.lambda = met_[best].lambda, t.mode = met_[best].mode;
    } else {
      t.id = next_id_++;
    }
    places_.push_back({t.id, t.first_place, t.second_place, t.left_over, t.lambda, t.mode,
                       best < known && met_[best].rests});
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
