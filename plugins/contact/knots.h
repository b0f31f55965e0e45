// Component Knots: finds the tight knots of a thread, says what they are, and makes them rigid.
#pragma once

#include <vector>

#include "contact.h"
#include "knot_type.h"
#include "sutura/geometry/curve_segments.h"
#include "touch_clusters.h"

namespace sutura::contact {

class Knots : public Component, public ConstraintSource {
 public:
  static void describe(Describe<Knots>& d);
  void initialise(Setup& setup) override;
  void archive(Archive& archive) override;
  void build(const StepContext& context, ConstraintBuilder& builder) override;
  bool revise(const StepContext& context, const SolvedBlocks& solved) override;
  void commit(const StepContext& context, const SolvedBlocks& solved) override;

 private:
  /// Of a rigid knot: from abscissa to abscissa.
  struct Stretch {
    Real from = 0, to = 0;
    Pose place;  ///< of the section at `from`, seen from that of the first stretch
  };
  struct Knot {
    Index number = 0;  ///< never used again
    Real from = 0, to = 0;
    Real quiet = 0;  ///< for how long it has been at rest (s)
    bool is_typed = false, is_rigid = false;
    bool holds = true;  ///< a rigid one, what is asked of it in this step
    KnotType type;
    Real load = 0;  ///< largest force in a strand that comes out of it (N)
    Real held = 0;  ///< the largest of those at which it was seen at rest
    std::vector<Stretch> stretches;
    std::vector<Vec3> seen;  ///< forces of the strands when it became rigid, seen from it (N)
    Real departure = 0;      ///< by what share one of these differs now, at most
    bool is_tight() const { return is_typed && type.is_knot; }
  };

  void look_at(const TouchCluster& cluster, Real dt);
  bool is_still_rigid(Knot& knot);
  void free(Knot& knot);
  void make_rigid(Knot& knot);
  void find_type(Knot& now);
  KnotType type_of(Real first, Real last);
  /// Forces of all strands that come out of the knot, seen from it (N); returns the largest.
  Real measure(const std::vector<Stretch>& stretches, std::vector<Vec3>& forces) const;
  /// Into `ranges_`: the stretches of a cluster from node to node of the thread; none if the thread
  /// cannot make them rigid.
  void find_ranges(const TouchCluster& cluster);
  Pose leader(const Stretch& stretch) const;
  Index body(const Knot& knot) const;

  Link<Contact> contact_;
  bool rigidify_ = false;
  Real slow_ = 1e-4, tension_ = 1e-3, still_for_ = 50e-3, tolerance_ = 0.1;

  SegmentedCurve* curve_ = nullptr;
  RigidStretches* rigid_ = nullptr;
  Index source_id_ = 0;
  TouchClusters clusters_;
  std::vector<Knot> knots_, before_;  ///< ascending along the thread
  std::vector<CurveSegment> segments_;
  std::vector<Vec3> forces_;
  std::vector<Stretch> ranges_;
  Index next_number_ = 0, releases_ = 0;
};

}  // namespace sutura::contact
