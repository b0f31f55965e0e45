// Stretches of a chain that move as rigid bodies: of each only the first node is free, and the
// others follow it. So the chain stays a chain, with fewer nodes.
//
// What acts on a follower acts on its leader, with the moment of the force there; that is all that
// the balance and the matrix of a step have to know (virtual work: delta x = delta x_lead +
// delta turn x arm).
#pragma once

#include <vector>

#include "sutura/types.h"

namespace sutura {
class Archive;
}

namespace sutura::thread {

/// Nodes first .. last and the beams between them.
struct RigidStretch {
  Index body = 0;  ///< a number, by which it is released; several may share it
  Index first = 0, last = 0;
};

class Stretches {
 public:
  /// None, on so many nodes.
  void clear(Index nodes);
  void reserve(Index nodes);
  /// Must share no node with another.
  void add(const RigidStretch& stretch);
  /// Those of this body. False if there is none.
  bool remove(Index body);
  /// False if the archive holds those of another chain.
  void archive(Archive& archive);

  const std::vector<RigidStretch>& all() const { return all_; }
  bool empty() const { return all_.empty(); }
  /// The node that this one follows; itself, if it is free.
  Index lead(Index node) const { return lead_[node]; }
  bool follows(Index node) const { return lead_[node] != node; }
  bool is_rigid(Index beam) const { return lead_[beam] == lead_[beam + 1]; }
  /// Which body the beam is part of, or -1.
  Index body_of(Index beam) const;
  /// Nodes that are free, and the number of a node, or of its leader, among them.
  Index blocks() const { return block_.back() + 1; }
  Index block(Index node) const { return block_[node]; }

  /// From leader to node.
  Vec3 arm(const std::vector<Pose>& poses, Index node) const {
    return poses[node].position - poses[lead_[node]].position;
  }
  /// What acts on a node (N, N m), as it acts on its leader.
  Vec6 on_leader(const std::vector<Pose>& poses, Index node, const Vec6& force) const;
  /// Forces on followers go over to their leaders; columns of 6 per node.
  void gather(const std::vector<Pose>& poses, Eigen::Ref<MatX> forces) const;
  /// Followers move (m/s, rad/s, or small shifts and spins) as their leaders do.
  void spread(const std::vector<Pose>& poses, Eigen::Ref<VecX> velocity) const;
  /// From 6 rows per node to 6 per block in the rows at the top, forces gathered; and back, with
  /// motions spread.
  void pack(const std::vector<Pose>& poses, Eigen::Ref<MatX> forces) const;
  void unpack(const std::vector<Pose>& poses, Eigen::Ref<MatX> motions) const;
  /// In a finite motion from `start` (shift, turn: see `turned`) followers go with their leaders.
  void follow(const std::vector<Pose>& start, Eigen::Ref<VecX> motion) const;

 private:
  void number();

  std::vector<RigidStretch> all_;  ///< ascending
  std::vector<Index> lead_, block_;
};

}  // namespace sutura::thread
