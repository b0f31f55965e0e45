#include "stretches.h"

#include <algorithm>
#include <cassert>

#include "chain_motion.h"
#include "sutura/archive.h"
#include "sutura/geometry/poses.h"

namespace sutura::thread {

void Stretches::clear(Index nodes) {
  all_.clear();
  lead_.resize(static_cast<std::size_t>(nodes));
  block_.resize(static_cast<std::size_t>(nodes));
  number();
}

void Stretches::reserve(Index nodes) {
  lead_.reserve(static_cast<std::size_t>(nodes));
  block_.reserve(static_cast<std::size_t>(nodes));
}

void Stretches::add(const RigidStretch& stretch) {
  assert(0 <= stretch.first && stretch.first < stretch.last &&
         stretch.last < static_cast<Index>(lead_.size()));
  const auto after = std::find_if(all_.begin(), all_.end(), [&stretch](const RigidStretch& other) {
    return other.first > stretch.first;
  });
  all_.insert(after, stretch);
  number();
}

bool Stretches::remove(Index body) {
  const auto gone =
      std::erase_if(all_, [body](const RigidStretch& each) { return each.body == body; });
  if (gone > 0) number();
  return gone > 0;
}

void Stretches::number() {
  for (std::size_t i = 0; i < lead_.size(); ++i) lead_[i] = static_cast<Index>(i);
  for (const RigidStretch& s : all_)
    for (Index i = s.first; i <= s.last; ++i) lead_[i] = s.first;
  Index block = -1;
  for (std::size_t i = 0; i < lead_.size(); ++i) {
    block += lead_[i] == static_cast<Index>(i);
    block_[i] = block;
  }
}

Index Stretches::body_of(Index beam) const {
  if (!is_rigid(beam)) return -1;
  for (const RigidStretch& s : all_)
    if (s.first <= beam && beam < s.last) return s.body;
  return -1;
}

void Stretches::archive(Archive& a) {
  a.list("stretches", all_, [](Archive& each, RigidStretch& s) {
    each("body", s.body);
    each("first", s.first);
    each("last", s.last);
  });
  if (!a.restoring()) return;
  Index free = 0;
  for (const RigidStretch& s : all_) {
    if (!(free <= s.first && s.first < s.last && s.last < static_cast<Index>(lead_.size()))) {
      a.fail("rigid stretches of another thread");
      all_.clear();
      break;
    }
    free = s.last + 1;
  }
  number();
}

Vec6 Stretches::on_leader(const std::vector<Pose>& poses, Index node, const Vec6& force) const {
  Vec6 there = force;
  if (follows(node)) there.tail<3>() += arm(poses, node).cross(Vec3(force.head<3>()));
  return there;
}

void Stretches::gather(const std::vector<Pose>& poses, Eigen::Ref<MatX> forces) const {
  for (const RigidStretch& s : all_)
    for (Index i = s.first + 1; i <= s.last; ++i)
      for (Index c = 0; c < forces.cols(); ++c) {
        auto own = forces.col(c).segment<6>(6 * i);
        forces.col(c).segment<6>(6 * s.first) += on_leader(poses, i, own);
        own.setZero();
      }
}

void Stretches::spread(const std::vector<Pose>& poses, Eigen::Ref<VecX> velocity) const {
  for (const RigidStretch& s : all_) {
    const Vec3 shift = velocity.segment<3>(6 * s.first),
               spin = velocity.segment<3>(6 * s.first + 3);
    for (Index i = s.first + 1; i <= s.last; ++i) {
      velocity.segment<3>(6 * i) = shift + spin.cross(arm(poses, i));
      velocity.segment<3>(6 * i + 3) = spin;
    }
  }
}

void Stretches::pack(const std::vector<Pose>& poses, Eigen::Ref<MatX> forces) const {
  if (empty()) return;
  gather(poses, forces);
  for (Index i = 0; i < static_cast<Index>(lead_.size()); ++i)
    if (!follows(i) && block_[i] != i)
      forces.middleRows<6>(6 * block_[i]) = forces.middleRows<6>(6 * i);
}

void Stretches::unpack(const std::vector<Pose>& poses, Eigen::Ref<MatX> motions) const {
  if (empty()) return;
  for (auto i = static_cast<Index>(lead_.size()); i-- > 0;)
    if (!follows(i) && block_[i] != i)
      motions.middleRows<6>(6 * i) = motions.middleRows<6>(6 * block_[i]);
  for (Index c = 0; c < motions.cols(); ++c) spread(poses, motions.col(c));
}

void Stretches::follow(const std::vector<Pose>& start, Eigen::Ref<VecX> motion) const {
  for (const RigidStretch& s : all_) {
    const Quat& before = start[s.first].rotation;
    const Vec3 shift = motion.segment<3>(6 * s.first);
    const Quat turn = turned(before, motion.segment<3>(6 * s.first + 3)) * before.conjugate();
    for (Index i = s.first + 1; i <= s.last; ++i) {
      const Vec3 r = arm(start, i), from = tangent(start[i]), to = turn * from;
      // It tilts as its tangent does, and rolls by what is left of the turn.
      const Quat tilt = shortest_rotation(from, to);
      const Vec3 roll = rotation_between(tilt, turn);
      motion.segment<3>(6 * i) = shift + turn * r - r;
      motion.segment<3>(6 * i + 3) = rotation_between(Quat::Identity(), tilt) + roll.dot(to) * from;
    }
  }
}

}  // namespace sutura::thread
