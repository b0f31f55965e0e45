#include "knots.h"

#include <algorithm>
#include <cmath>

#include "sutura/archive.h"
#include "sutura/geometry/poses.h"
#include "sutura/laws/bilateral.h"

namespace sutura::contact {
namespace {

// In diameters of the thread: where touches are further apart along it, what is between is not part
// of the knot, such as the loop of a suture.
constexpr Real reach = 10;
// Of the largest force of its strands: so much of a loose end keeps a knot shut.
constexpr Real counts = 0.02;
constexpr Index none = -1;
constexpr std::size_t usual = 16;  // touches that hang together, at once: room from the start

}  // namespace

void Knots::describe(Describe<Knots>& d) {
  d.summary("Finds the tight knots of a thread, says which they are, and can make them rigid.");
  d.theory(
      "Touches of the thread with itself that hang together are a knot when the line of the thread "
      "is knotted there (its Jones polynomial is not 1), a strand that comes out of it is under "
      "'tension', and for a while ('still_for') no touch slips faster than 'slow'. With 'rigidify' "
      "its stretches of thread then move as one rigid body: one node instead of all of theirs, no "
      "touches within; several stretches, such as the two legs of a suture's loop, are held "
      "together by six rows. The knot was seen to hold the load of that time, which are the forces "
      "of the strands that come out of it. When one differs from it by more than 'tolerance', it "
      "is free again, with the forces in it that it had, and its touches show in the next steps "
      "whether they hold the new load: then it becomes rigid again, else it slips, as it does "
      "without this component.");
  d.link("contact", &Knots::contact_, "A Contact of the thread with itself.");
  d.attribute("rigidify", &Knots::rigidify_, "Whether tight knots become rigid.");
  d.attribute("slow", &Knots::slow_, "m/s", between(0, 1e3),
              "What slips slower than this is taken for at rest.");
  d.attribute("tension", &Knots::tension_, "N", between(0, 1e6),
              "The least force in a strand that comes out of a tight knot.");
  d.attribute("still_for", &Knots::still_for_, "s", between(0, 1e6),
              "For so long a knot must have been at rest.");
  d.attribute("tolerance", &Knots::tolerance_, "1", between(0, 1),
              "By what share of itself the force of each strand may differ from that at which a "
              "rigid knot was seen at rest; of a strand that bears less, of 'tension' or of a "
              "fiftieth of the largest force.");
  const auto sum = [](const Knots& all, auto of) {
    Real total = 0;
    for (const Knot& k : all.knots_)
      if (k.is_tight()) total += static_cast<Real>(of(k));
    return total;
  };
  const auto largest = [](const Knots& all, auto of) {
    Real most = 0;
    for (const Knot& k : all.knots_)
      if (k.is_tight()) most = std::max<Real>(most, of(k));
    return most;
  };
  d.output("found", "1", "Number of tight knots.",
           [sum](const Knots& all) { return sum(all, [](const Knot&) { return 1; }); });
  d.output("rigid", "1", "Of these, how many are rigid.",
           [sum](const Knots& all) { return sum(all, [](const Knot& k) { return k.is_rigid; }); });
  d.output(
      "throws", "1", "Throws of all of them, where they can be told.",
      [sum](const Knots& all) { return sum(all, [](const Knot& k) { return k.type.throws; }); });
  d.output("left_throws", "1",
           "Of these, left-handed: one of two in a square knot, none or both in a granny.",
           [sum](const Knots& all) { return sum(all, [](const Knot& k) { return k.type.left; }); });
  d.output(
      "crossings", "1",
      "Of the throws: 3 for one turn, 5 for two, 7 for three; a surgeon's knot has 8.",
      [sum](const Knots& all) { return sum(all, [](const Knot& k) { return k.type.crossings; }); });
  d.output("determinant", "1",
           "Of the knot, the largest of all: the product of the crossings of its throws, whatever "
           "kind it is of; 0 where it is not known.",
           [largest](const Knots& all) {
             return largest(all, [](const Knot& k) { return k.type.determinant; });
           });
  d.output(
      "load", "N", "The largest force in a strand that comes out of a tight knot.",
      [largest](const Knots& all) { return largest(all, [](const Knot& k) { return k.load; }); });
  d.output(
      "held", "N", "The largest load at which such a knot was at rest, since it was found.",
      [largest](const Knots& all) { return largest(all, [](const Knot& k) { return k.held; }); });
  d.output("departure", "1",
           "By what share the force of a strand differs now, at most, from that at which a rigid "
           "knot was seen at rest: what makes it free above 'tolerance'.",
           [largest](const Knots& all) {
             return largest(all, [](const Knot& k) { return k.is_rigid ? k.departure : 0; });
           });
  d.output("releases", "1", "How often a rigid knot was made free, since the start.",
           [](const Knots& all) { return static_cast<Real>(all.releases_); });
}

void Knots::initialise(Setup& setup) {
  source_id_ = setup.source_id;
  curve_ = contact_->own_curve();
  rigid_ = dynamic_cast<RigidStretches*>(curve_);
  if (rigid_ == nullptr) setup.error(*this, "'contact' is not one of a thread with itself");
  for (auto* knots : {&knots_, &before_}) knots->reserve(usual);
}

Index Knots::body(const Knot& knot) const {
  return source_id_ << 20 | knot.number;
}

Pose Knots::leader(const Stretch& s) const {
  return curve_->frame(s.from, Configuration::current);
}

/// Six rows for each stretch after the first: its leader stays where it was beside the first one's.
/// Turns count by the way they lead at half the length of the stretch, so that all rows are in
/// metres.
void Knots::build(const StepContext&, ConstraintBuilder& builder) {
  PointJacobian J;
  for (const Knot& knot : knots_) {
    if (!knot.is_rigid || !rigid_->is_rigid(body(knot))) continue;
    const Pose first = leader(knot.stretches.front());
    for (std::size_t k = 1; k < knot.stretches.size(); ++k) {
      const Stretch& s = knot.stretches[k];
      const Pose is = leader(s), due = compose(first, s.place);
      const Real lever = (s.to - s.from) / 2;
      const Quat off = is.rotation * due.rotation.conjugate();
      const Eigen::AngleAxis<Real> turn(off);
      BlockVector<6> gap;
      gap.head<3>() = is.position - due.position;
      gap.tail<3>() = lever * turn.angle() * turn.axis();
      const std::uint64_t name = static_cast<std::uint64_t>(knot.number) << 8 | k;
      const BlockId block = builder.add<Bilateral<6>>(make_key(source_id_, name), {}, gap);
      const auto couple = [&](Real at, const Vec3& arm, Real sign) {
        Directions directions = Directions::Zero(6, 3);
        directions.topRows<3>() = sign * Mat3::Identity();
        // Spin about e is what a point at f is faster along g than the middle, e = f x g.
        for (int e = 0; e < 3; ++e) directions(3 + e, (e + 2) % 3) = -sign;
        curve_->surface_jacobian(at, arm, J);
        builder.couple(block, *curve_, directions, J, is.position);
        for (int e = 0; e < 3; ++e) {
          Directions one = Directions::Zero(6, 3);
          one(3 + e, (e + 2) % 3) = sign;
          curve_->surface_jacobian(at, arm + lever * Vec3::Unit((e + 1) % 3), J);
          builder.couple(block, *curve_, one, J, is.position);
        }
      };
      couple(s.from, Vec3::Zero(), 1);
      couple(knot.stretches.front().from, is.position - first.position, -1);
    }
  }
}

/// A knot is rigid in no step that asks another load of it than it was seen to hold: rigid it gives
/// no slack, and its hand would feel the stretch of the thread beside it.
bool Knots::revise(const StepContext&, const SolvedBlocks&) {
  bool revised = false;
  for (Knot& knot : knots_) knot.holds = !knot.is_rigid || is_still_rigid(knot);
  for (Knot& knot : knots_) {
    if (knot.holds) continue;
    free(knot);
    revised = true;
  }
  return revised;
}

void Knots::commit(const StepContext& context, const SolvedBlocks&) {
  before_.swap(knots_);
  knots_.clear();
  for (Knot& knot : before_) {
    if (!knot.is_rigid) continue;
    if (!is_still_rigid(knot)) free(knot);
    knots_.push_back(std::move(knot));
    knot.number = none;  // nothing goes on from it in this step: its touches are not known yet
  }
  const Real diameter = 2 * curve_->radius(curve_->length());
  for (const TouchCluster& cluster : clusters_.find(contact_->touches(), reach * diameter))
    look_at(cluster, context.dt);
  std::sort(knots_.begin(), knots_.end(),
            [](const Knot& a, const Knot& b) { return a.from < b.from; });
}

/// The knot that it was before, if there was one at its place, goes on.
void Knots::look_at(const TouchCluster& cluster, Real dt) {
  Knot now;
  now.number = none;
  const Real near = reach * 2 * curve_->radius(curve_->length());
  for (Knot& old : before_) {
    if (old.number == none || std::abs(old.from - cluster.first()) > near ||
        std::abs(old.to - cluster.last()) > near)
      continue;
    now = std::move(old);
    old.number = none;
    break;
  }
  if (now.number == none) now.number = next_number_++;
  now.from = cluster.first(), now.to = cluster.last();
  find_ranges(cluster);
  now.load = measure(ranges_, forces_);
  // Where a tail lies across a leg, the knot is not there but where most touches are.
  const bool rests = !cluster.is_lesser && cluster.fastest <= slow_ * dt && now.load >= tension_;
  now.quiet = rests ? now.quiet + dt : 0;
  if (!rests) now.is_typed = false;
  if (rests && now.quiet > still_for_ * (1 - 1e-9)) {
    if (!now.is_typed) find_type(now);
    now.held = std::max(now.held, now.load);
    if (rigidify_ && now.is_tight()) make_rigid(now);
  }
  knots_.push_back(std::move(now));
}

/// Touches beside a tight knot are no knot of their own. Either they are at its rim; or, if the two
/// together are another knot than the rigid one, that is found as soon as all of it is free.
void Knots::find_type(Knot& now) {
  Knot* beside = nullptr;
  for (Knot& other : knots_)
    if (other.is_tight() && other.from <= now.to && other.to >= now.from) beside = &other;
  now.is_typed = true;
  if (beside == nullptr) {
    now.type = type_of(now.from, now.to);
    return;
  }
  now.type = {};
  if (!beside->is_rigid ||
      type_of(std::min(beside->from, now.from), std::max(beside->to, now.to)) == beside->type)
    return;
  free(*beside);
  now.is_typed = false;
}

void Knots::make_rigid(Knot& knot) {
  if (ranges_.empty()) return;
  knot.is_rigid = true;
  knot.stretches = ranges_;
  knot.departure = 0;
  const Pose first = leader(ranges_.front());
  const Quat back = first.rotation.conjugate();
  for (Stretch& s : knot.stretches) {
    const Pose place = leader(s);
    s.place = {seen_from(first, place.position), (back * place.rotation).normalized()};
    rigid_->make_rigid(body(knot), s.from, s.to);
  }
  knot.seen = forces_;
}

void Knots::free(Knot& knot) {
  rigid_->release(body(knot));
  knot.is_rigid = false;
  knot.quiet = 0;
  ++releases_;
  for (auto* list : {&knots_, &before_})
    for (Knot& each : *list) each.is_typed = each.is_typed && each.is_rigid;
}

bool Knots::is_still_rigid(Knot& knot) {
  if (!rigid_->is_rigid(body(knot))) return false;
  knot.load = measure(knot.stretches, forces_);
  Real most = 0;
  for (const Vec3& seen : knot.seen) most = std::max(most, seen.norm());
  const Real least = std::max(tension_, counts * most);
  knot.departure = 0;
  for (std::size_t i = 0; i < forces_.size(); ++i)
    knot.departure = std::max(
        knot.departure, (forces_[i] - knot.seen[i]).norm() / std::max(knot.seen[i].norm(), least));
  return knot.departure <= tolerance_ && knot.load >= tension_;
}

Real Knots::measure(const std::vector<Stretch>& stretches, std::vector<Vec3>& forces) const {
  forces.clear();
  Real most = 0;
  for (const Stretch& s : stretches)
    for (const bool before : {true, false}) {
      const Vec3 force = rigid_->end_wrench(before ? s.from : s.to, before).force;
      forces.push_back(leader(stretches.front()).rotation.conjugate() * force);
      most = std::max(most, force.norm());
    }
  return most;
}

void Knots::find_ranges(const TouchCluster& cluster) {
  ranges_.clear();
  for (const auto& [from, to] : cluster.stretches) {
    const Real rim = curve_->radius(from);  // touches lie within
    const auto range = rigid_->rigid_range(from - rim, to + rim);
    if (!range) return ranges_.clear();
    if (!ranges_.empty() && range->first <= ranges_.back().to)
      ranges_.back().to = range->second;
    else
      ranges_.push_back({range->first, range->second, {}});
  }
}

/// Of the thread until it is out of the ball around the knot, and at most as far as the next tight
/// knots, where it is cut, or its ends: what comes later, such as another knot that is still loose,
/// is no part of this one. From there it goes straight on, away from the knot.
KnotType Knots::type_of(Real first, Real last) {
  Real from = 0, to = curve_->length();
  for (const auto* list : {&knots_, &before_})
    for (const Knot& other : *list) {
      if (!other.is_tight()) continue;
      if (other.to < first) from = std::max(from, other.to);
      if (other.from > last) to = std::min(to, other.from);
    }
  curve_->segments(Configuration::current, segments_);
  Vec3 middle = Vec3::Zero();
  Real inside = 0, ball = 0;
  const auto is_inside = [&](const CurveSegment& s) { return s.to >= first && s.from <= last; };
  for (const CurveSegment& s : segments_) {
    if (is_inside(s)) middle += s.xa, ++inside;
    if (s.cut && s.to <= first) from = std::max(from, s.to);
    if (s.cut && s.from >= last) to = std::min(to, s.from);
  }
  middle /= inside;
  for (const CurveSegment& s : segments_)
    if (is_inside(s)) ball = std::max({ball, (s.xa - middle).norm(), (s.xb - middle).norm()});
  const auto is_out = [&](const Vec3& p) { return (p - middle).norm() > 1.05 * ball; };
  for (const CurveSegment& s : segments_) {
    if (s.to < first && is_out(s.xa)) from = std::max(from, s.from);
    if (s.from > last && is_out(s.xb)) to = std::min(to, s.to);
  }
  std::vector<Vec3> line;
  Vec3 end = middle;
  for (const CurveSegment& s : segments_) {
    if (s.from < from || s.to > to) continue;
    constexpr int parts = 4;
    for (int k = 0; k < parts; ++k) line.push_back(s.point(static_cast<Real>(k) / parts));
    end = s.xb;
  }
  line.push_back(end);
  const auto far = [&](const Vec3& p) { return Vec3(p + 100 * ball * (p - middle).normalized()); };
  line.insert(line.begin(), far(line.front()));
  line.push_back(far(line.back()));
  return knot_type(simplified(line, curve_->radius(last) / 10));
}

void Knots::archive(Archive& a) {
  a.list("knots", knots_, [](Archive& each, Knot& k) {
    each("number", k.number);
    each("from", k.from);
    each("to", k.to);
    each("quiet", k.quiet);
    each("is_typed", k.is_typed);
    each("is_rigid", k.is_rigid);
    each("is_knot", k.type.is_knot);
    each("is_known", k.type.is_known);
    each("throws", k.type.throws);
    each("left", k.type.left);
    each("crossings", k.type.crossings);
    each("determinant", k.type.determinant);
    each("load", k.load);
    each("held", k.held);
    each.list("stretches", k.stretches, [](Archive& one, Stretch& s) {
      one("from", s.from);
      one("to", s.to);
      one("place", s.place);
    });
    each("seen", k.seen);
    each("departure", k.departure);
  });
  a("next_number", next_number_);
  a("releases", releases_);
  for (const Knot& k : knots_)
    if (k.is_rigid && (k.stretches.empty() || k.seen.size() != 2 * k.stretches.size()))
      a.fail("a rigid knot without stretches");
}

}  // namespace sutura::contact
