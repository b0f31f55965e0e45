#include "channel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "sutura/archive.h"

namespace sutura::suturing {
namespace {

// In units of the spacing of samples.
constexpr Real at_end = 0.02;  // a tip that is closer to the end of the channel is at its end
constexpr Real longest = 1.5;  // channel between two samples: the last part before an exit
constexpr Real lost = 2;       // a tip that is further past a sample went another way

constexpr Real mouth = 2;  // in radii of the needle: from so far a tip slides into a mouth
/// A curve that turns by less than half a circle is at most pi / 2 times as long as its chord.
constexpr Real arc_over_chord = 2;

}  // namespace

Channel::Channel(const CurveBody& thread, const SolidBody& tissue, Real spacing)
    : thread_(thread), tissue_(tissue), pieces_(thread), spacing_(spacing) {
  samples_.reserve(256);
}

bool Channel::tip_inside() const {
  return passed_ > 0 && samples_[passed_ - 1].kind != PathSample::Kind::exit &&
         piece_at(passed_ - 1).low == 0;
}

Real Channel::tip_depth() const {
  return tip_inside() ? samples_[passed_ - 1].depth + samples_[passed_ - 1].abscissa - ahead_ : 0;
}

bool Channel::tip_at_end() const {
  return tip_inside() && passed_ == samples_.size() && tip_depth() > end_depth_ - at_end * spacing_;
}

bool Channel::is_joined(std::size_t i) const {
  return i > 0 && samples_[i].kind != PathSample::Kind::entry &&
         samples_[i - 1].kind != PathSample::Kind::exit &&
         samples_[i - 1].abscissa <= piece_at(i).high;
}

Channel::Share Channel::share_of(std::size_t i) const {
  const PathSample& s = samples_[i];
  const Pieces::Piece piece = piece_at(i);
  Share share{s.abscissa, s.abscissa};
  // An end that is further away than samples are from each other has gone out of the channel again.
  if (is_joined(i)) {
    share.high = 0.5 * (s.abscissa + samples_[i - 1].abscissa);
  } else if (s.kind != PathSample::Kind::entry) {
    share.high = std::min(piece.high, s.abscissa + longest * spacing_);
  }
  if (s.kind == PathSample::Kind::exit) return share;
  if (i + 1 < passed_ && is_joined(i + 1)) {
    share.low = 0.5 * (s.abscissa + samples_[i + 1].abscissa);
  } else {
    share.low = piece.low > 0 ? std::max(piece.low, s.abscissa - longest * spacing_) : 0;
  }
  return share;
}

Real Channel::inserted_length() const {
  Real sum = 0;
  for (std::size_t i = 0; i < passed_; ++i) {
    const Share share = share_of(i);
    sum += share.high - share.low;
  }
  return sum;
}

Real Channel::mouth_radius() const {
  return mouth * thread_.radius(0);
}

bool Channel::mouth_near(const Vec3& point) const {
  if (passed_ == samples_.size() || samples_[passed_].kind != PathSample::Kind::entry) return false;
  const Vec3 at = tissue_.position(samples_[passed_].at, Configuration::current);
  return (at - point).norm() < mouth_radius();
}

/// Length of needle, from its tip, on which its point closest to `at` is sought (m).
Real Channel::search_length(const Vec3& at) const {
  return std::min(arc_over_chord * (at - tip()).norm() + spacing_, thread_.length());
}

void Channel::push(const EmbeddedPoint& at, Real depth, Real abscissa, PathSample::Kind kind) {
  const Real slip = kind == PathSample::Kind::entry ? 0 : samples_.back().slip;
  samples_.push_back({.id = next_id_++,
                      .at = at,
                      .depth = depth,
                      .abscissa = abscissa,
                      .slip = slip,
                      .across = thread_.tangent(abscissa, Configuration::current).unitOrthogonal(),
                      .kind = kind});
  passed_ = samples_.size();
  ahead_ = lead_ = 0;
}

EmbeddedPoint Channel::embed(const Vec3& point) const {
  if (const auto inside = tissue_.locate(point, Configuration::current)) return *inside;
  // A point that grazes the surface is kept at its foot on it.
  if (const auto foot = tissue_.closest_surface(point, spacing_, Configuration::current)) {
    return foot->at;
  }
  return end_;
}

/// Where the needle behind its tip goes through the surface: after a sudden puncture that is not
/// quite where the tip pressed. `facing`: the way its outward normal leans. The tip may be through
/// other surfaces that lean that way as well.
EmbeddedPoint Channel::mouth_at_needle(const EmbeddedPoint& pressed, const Vec3& facing) const {
  const Real reach = search_length(tissue_.position(pressed, Configuration::current));
  const Vec3 place = tissue_.position(pressed, Configuration::current);
  Vec3 from = tip();
  Real least = std::numeric_limits<Real>::infinity();
  EmbeddedPoint mouth = pressed;
  for (Real s = 0; s < reach;) {
    s = std::min(s + search_step * spacing_, reach);
    const Vec3 to = thread_.point(s, Configuration::current);
    const auto hit = tissue_.crossing(from, to, Configuration::current, facing);
    const Real distance = hit ? (hit->position - place).norm() : least;
    if (distance < least) {
      least = distance;
      mouth = hit->at;
    }
    from = to;
  }
  return mouth;
}

void Channel::enter(const EmbeddedPoint& pressed, bool goes_on) {
  samples_.resize(passed_);  // what an earlier, abandoned channel left
  const EmbeddedPoint mouth = mouth_at_needle(pressed, -advance_direction());
  const Vec3 at = tissue_.position(mouth, Configuration::current);
  const Real s = thread_.closest_abscissa(at, 0, 0, search_length(at), Configuration::current);
  push(mouth, 0, s, PathSample::Kind::entry);
  end_ = mouth;
  end_depth_ = 0;
  ahead_ = lead_ = std::max(advance_direction().dot(at - tip()), Real(0));
  if (!goes_on) record();
}

void Channel::leave(const EmbeddedPoint& pressed) {
  samples_.resize(passed_);
  const EmbeddedPoint mouth = mouth_at_needle(pressed, advance_direction());
  const Vec3 at = tissue_.position(mouth, Configuration::current);
  const PathSample last = samples_.back();
  const Real s =
      thread_.closest_abscissa(at, 0, 0, std::max(last.abscissa, Real(0)), Configuration::current);
  const Real depth = last.depth + std::max(last.abscissa - s, Real(0));
  fill(depth, s);
  const PathSample& before = samples_.back();
  if (before.kind == PathSample::Kind::inner && depth - before.depth < too_close * spacing_) {
    samples_.pop_back();
  }
  push(mouth, depth, s, PathSample::Kind::exit);
  end_ = mouth;
  end_depth_ = samples_.back().depth;
}

std::size_t Channel::index_of(std::uint64_t id) const {
  const auto it = std::lower_bound(samples_.begin(), samples_.end(), id,
                                   [](const PathSample& s, std::uint64_t i) { return s.id < i; });
  const bool there = it != samples_.end() && it->id == id;
  return static_cast<std::size_t>((there ? it : samples_.end()) - samples_.begin());
}

const PathSample* Channel::find(std::uint64_t id) const {
  const std::size_t i = index_of(id);
  return i < passed_ ? &samples_[i] : nullptr;
}

void Channel::update(bool blocked, const Vec3& along, bool let_out) {
  got_out_ = false;
  find_abscissae();
  drop_where_thread_ends();
  retract(blocked, along);
  readvance();
  if (!tip_inside() || passed_ != samples_.size() || let_out) return;
  const Vec3 from_end = tip() - tissue_.position(end_, Configuration::current);
  if (!blocked || along.dot(from_end) > at_end * spacing_) record(blocked);
}

/// From the tip backwards: abscissae grow in the order in which the channel was entered, so each
/// search is bounded by the one before it and cannot jump to another loop of the thread.
void Channel::find_abscissae() {
  Real low = 0;
  for (std::size_t i = passed_; i-- > 0;) {
    PathSample& s = samples_[i];
    const Vec3 at = tissue_.position(s.at, Configuration::current);
    const Real before = s.abscissa;
    const Pieces::Piece piece = piece_at(i);
    low = std::max(low, piece.low);
    s.abscissa = thread_.closest_abscissa(at, std::max(low, before + s.slip), low, piece.high,
                                          Configuration::current);
    s.slip = s.abscissa - before;
    low = s.abscissa;
  }
}

/// An end of the piece of thread at sample i has gone by. In a mouth it stays until it is a
/// diameter away: before, it still lies in the surface, with which it would be in contact at once.
bool Channel::has_lost_its_thread(std::size_t i) const {
  const PathSample& s = samples_[i];
  const Pieces::Piece piece = piece_at(i);
  if (!piece.ends_at(s.abscissa)) return false;
  if (s.kind == PathSample::Kind::inner || !(piece.low < piece.high)) return true;
  const Vec3 away = thread_.point(s.abscissa, now) - tissue_.position(s.at, now);
  return away.norm() > 2 * thread_.radius(s.abscissa);
}

/// The channel behind an end is empty. Where the piece of the tip begins the tip is, which may come
/// back.
void Channel::drop_where_thread_ends() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < passed_; ++i)
    if (!has_lost_its_thread(i)) samples_[kept++] = samples_[i];
  samples_.erase(samples_.begin() + static_cast<std::ptrdiff_t>(kept),
                 samples_.begin() + static_cast<std::ptrdiff_t>(passed_));
  passed_ = kept;
}

void Channel::look_for_cuts() {
  pieces_.look();
  drop_where_thread_ends();
}

/// A tip that has just pierced stands before its mouth, by what the mesh is dented more under it
/// than its footprint on average. The mouth holds it all the same, until it goes further back. So
/// does what is behind a tip that a surface holds from the inside, by the mean of a footprint too:
/// in a thin sheet that is pressed into a tent the mouth is ahead of it. What a tip has cut along
/// that surface it leaves where it goes back along it.
void Channel::retract(bool blocked, const Vec3& along) {
  const Vec3 tip_position = tip();
  const Vec3 forward = advance_direction();
  for (; passed_ > 0; --passed_) {
    const PathSample& last = samples_[passed_ - 1];
    const Vec3 at = tissue_.position(last.at, Configuration::current);
    ahead_ = last.abscissa > 0 ? 0 : std::max(forward.dot(at - tip_position), Real(0));
    const bool went_back =
        last.kind == PathSample::Kind::inner && along.dot(at - tip_position) > at_end * spacing_;
    if (blocked && !went_back) lead_ = std::max(lead_, ahead_);
    if (ahead_ <= lead_) return;
    ahead_ = lead_ = 0;
  }
}

void Channel::readvance() {
  const Vec3 tip_position = tip();
  const Vec3 forward = advance_direction();
  while (passed_ < samples_.size()) {
    PathSample& next = samples_[passed_];
    const Vec3 offset = tip_position - tissue_.position(next.at, Configuration::current);
    const Real along = forward.dot(offset);
    const Real aside = (offset - along * forward).norm();
    const bool into_mouth = next.kind != PathSample::Kind::entry || aside < mouth_radius();
    if (along < 0 || along > lost * spacing_ || !into_mouth) break;
    next.abscissa = along;
    next.slip = 0;
    ++passed_;
  }
}

void Channel::record(bool blocked) {
  const Real depth = tip_depth();
  if (depth <= end_depth_) return;
  if (!blocked && !tissue_.locate(tip(), Configuration::current)) {
    // The tip is outside without a puncture. Well clear of the surface the bite is over. Close to
    // it the tip may still be tenting: the footprint is held back on average, not every facet.
    const auto foot = tissue_.closest_surface(tip(), spacing_, Configuration::current);
    if (!foot) {
      leave(end_);
      got_out_ = true;
    }
    return;
  }
  end_ = embed(tip());
  end_depth_ = depth;
  fill(depth, 0);
}

/// Samples at their spacing up to this depth, where this section of the needle is.
void Channel::fill(Real depth, Real abscissa) {
  while (depth - samples_.back().depth >= spacing_) {
    const Real next = samples_.back().depth + spacing_;
    const Real s = abscissa + depth - next;
    push(embed(thread_.point(s, Configuration::current)), next, s, PathSample::Kind::inner);
  }
}

bool Channel::has_passed_wall() const {
  if (passed_ == 0) return false;
  std::size_t mouth = passed_ - 1;  // of the last bite
  while (mouth > 0 && samples_[mouth].kind != PathSample::Kind::entry) --mouth;
  const Real entry = samples_[mouth].abscissa, clear = thread_.radius(0);
  if (tip_inside()) return goes_through_surface(0, entry - clear, 1);
  const Real exit = samples_[passed_ - 1].abscissa;
  return goes_through_surface(0, exit - clear, -1) ||
         goes_through_surface(exit + clear, entry - clear, 1);
}

/// Whether the needle goes through a surface between two sections of it. `side`: 1 if the surface
/// faces against the way of the tip, -1 if it faces along.
bool Channel::goes_through_surface(Real low, Real high, Real side) const {
  Vec3 from = thread_.point(low, now);
  for (Real s = low; s < high;) {
    s = std::min(s + search_step * spacing_, high);
    const Vec3 to = thread_.point(s, now), back = thread_.tangent(s, now);
    if (tissue_.crossing(from, to, now, side * back)) return true;
    from = to;
  }
  return false;
}

void Channel::archive(Archive& a) {
  a.list("samples", samples_, [](Archive& each, PathSample& s) {
    each("id", s.id);
    each("at", s.at);
    each("depth", s.depth);
    each("abscissa", s.abscissa);
    each("slip", s.slip);
    each("lateral_force", s.lateral_force);
    each("across", s.across);
    each("kind", s.kind);
  });
  pieces_.archive(a);
  a("passed", passed_);
  a("end_depth", end_depth_);
  a("end", end_);
  a("ahead", ahead_);
  a("lead", lead_);
  a("next_id", next_id_);
  if (passed_ > samples_.size()) a.fail("more samples are on the thread than there are");
}

}  // namespace sutura::suturing
