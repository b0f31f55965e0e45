// The channel that a needle leaves in tissue: points fixed in the tissue, in the order of passage,
// and where along the thread each of them is now. Knows no constraint.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pieces.h"
#include "sutura/body.h"

namespace sutura {
class Archive;
}

namespace sutura::suturing {

/// A point of the channel. `depth` is the length of channel between the mouth of its bite and it.
struct PathSample {
  std::uint64_t id = 0;  ///< never reused
  EmbeddedPoint at;      ///< in the tissue
  Real depth = 0;        ///< m
  Real abscissa = 0;     ///< of the thread, at this point (m)
  Real slip = 0;  ///< change of the abscissa over the last step (m): positive when the tip advances
  Real lateral_force = 0;      ///< across what it stands for in the last step, spread (N)
  Vec3 across = Vec3::Zero();  ///< unit vector across the thread, turns as its tangent does
  enum class Kind { entry, inner, exit } kind = Kind::inner;
  bool cut_out = false;    ///< until drop_cut_out
  bool passed_by = false;  ///< by a mouth, likewise
};

/// Samples are kept in the order of passage: all before `passed` are on the thread, those after it
/// were left by a retracting tip and are remembered, so that the tip can come back through the same
/// channel without cutting.
class Channel {
 public:
  Channel(const CurveBody& thread, const SolidBody& tissue, Real spacing);

  /// Number of samples on the thread; they are samples()[0 .. passed).
  std::size_t passed() const { return passed_; }
  const std::vector<PathSample>& samples() const { return samples_; }

  bool tip_inside() const;
  /// The tip is at the end of what has been cut, as opposed to retracted.
  bool tip_at_end() const;
  /// Length of channel between the mouth and the tip, of the open bite (m); 0 outside. Negative
  /// while a tip that has just pierced stands before its mouth.
  Real tip_depth() const;
  /// Depth of the end of the recorded channel (m), its place in the tissue, its slip in the last
  /// step.
  Real end_depth() const { return end_depth_; }
  const EmbeddedPoint& end() const { return end_; }
  /// Length of thread or needle inside the tissue (m), over all bites.
  Real inserted_length() const;
  /// What sample i stands for: the thread between half way to its neighbours, from abscissa `low`
  /// to `high` (m). The last one before the tip has all that is between it and the tip, the one
  /// beside an end of the thread, or of what a cut has left, all that is between it and that end.
  /// The lengths add up to inserted_length.
  struct Share {
    Real low = 0;
    Real high = 0;
  };
  Share share_of(std::size_t i) const;
  /// Whether sample i and the one before it hold one stretch of thread, in one bite.
  bool is_joined(std::size_t i) const;
  /// The piece of thread that is at sample i.
  Pieces::Piece piece_at(std::size_t i) const { return pieces_.of(samples_[i].abscissa); }

  /// Whether the tip could slide in at `point` without puncture: through the mouth of a channel
  /// that is remembered but empty.
  bool mouth_near(const Vec3& point) const;

  /// The tip has just gone through the surface where it pressed, into the tissue: begins a bite.
  /// `goes_on`: it has also gone through what is behind; `leave` will end the bite there.
  void enter(const EmbeddedPoint& pressed, bool goes_on = false);
  /// The tip has just left the tissue where it pressed.
  void leave(const EmbeddedPoint& pressed);
  /// What of the thread lies in the tissue now is in its channel, bite after bite; what was
  /// recorded before is gone. Returns what of the thread is not as a sewn one is, or nothing
  /// (sewn.cpp).
  std::string sew();
  /// Looks where the thread has been cut since the last step: what a cut beam spans is no thread.
  void look_for_cuts();
  PathSample& sample(std::size_t i) { return samples_[i]; }
  /// The thread has cut sideways through the tissue, so that sample i of the channel, or its end,
  /// is at `point` now; a mouth is where the thread, as far away as it is from there, goes through
  /// the surface. Returns how far it has moved across the thread (m): a mouth at an edge of the
  /// tissue stays there until the thread is past it. (side_cut.cpp)
  Real cut_to(std::size_t i, const Vec3& point);
  Real cut_end_to(const Vec3& point);
  /// What has been cut out of the tissue is on the thread no more. A bite that is cut open in its
  /// middle becomes two; one of which nothing but a mouth is left is gone.
  void drop_cut_out();
  /// The sample with this id if it is on the thread, or null.
  const PathSample* find(std::uint64_t id) const;
  /// After each step: finds the abscissae, in order; drops samples behind the tip or past an end
  /// of their piece of thread, takes up remembered ones, and records the channel as far as the tip
  /// has come. `blocked`: a surface or layer holds the tip from the inside; what it has come
  /// further is the motion of that front, not a channel, but for what the tip has gone `along` it
  /// (a unit vector, or zero where there is no such way). `let_out`: a surface has just let the tip
  /// out; `leave` will end the bite there, wherever the tip is now.
  void update(bool blocked, const Vec3& along = Vec3::Zero(), bool let_out = false);
  /// The channel grows as far as the tip has come: samples at their spacing along the needle, each
  /// fixed to the tissue that is there now, and the end at the tip itself.
  void record(bool blocked = false);
  /// Whether the tip was found outside since the last update although no surface has let it out.
  bool got_out() const { return got_out_; }
  /// Whether a wall of the tissue is on the needle where none is known: between the tip and the
  /// last mouth a surface that faces as that mouth does, or in a bite that has just ended another
  /// way in. To be asked when the tip has just gone through a surface.
  bool has_passed_wall() const;
  void archive(Archive& archive);

 private:
  static constexpr Configuration now = Configuration::current;
  // In units of the spacing of samples.
  static constexpr Real search_step = 0.25;  ///< along the thread, for where it goes through a wall
  static constexpr Real too_close = 0.5;     ///< closer samples would hold the same section twice

  /// Index of the sample with this id, or the number of samples.
  std::size_t index_of(std::uint64_t id) const;
  void find_abscissae();
  void drop_where_thread_ends();
  bool has_lost_its_thread(std::size_t i) const;
  void retract(bool blocked, const Vec3& along);
  void readvance();
  std::optional<Real> find_mouth(Real from, Real to, const Vec3& facing) const;
  std::string fill_bite(Real exit);
  Real next_mouth(std::size_t i, bool to_end) const;
  std::optional<EmbeddedPoint> mouth_of(std::size_t i, const Vec3& apart, Real reach);
  void drop_passed_by();
  void make_mouth(std::size_t i, PathSample::Kind kind);
  void fill(Real depth, Real abscissa);
  bool goes_through_surface(Real low, Real high, Real side) const;
  void push(const EmbeddedPoint& at, Real depth, Real abscissa, PathSample::Kind kind);
  EmbeddedPoint mouth_at_needle(const EmbeddedPoint& pressed, const Vec3& facing) const;
  EmbeddedPoint embed(const Vec3& point) const;
  Real mouth_radius() const;
  Real search_length(const Vec3& at) const;
  Vec3 tip() const { return thread_.point(0, Configuration::current); }
  Vec3 advance_direction() const { return -thread_.tangent(0, Configuration::current); }

  const CurveBody& thread_;
  const SolidBody& tissue_;
  Pieces pieces_;
  Real spacing_;
  std::vector<PathSample> samples_;
  std::size_t passed_ = 0;
  Real end_depth_ = 0;
  Real ahead_ = 0;  ///< how far the mouth of the open bite lies in front of the tip (m)
  Real lead_ = 0;   ///< how far it may: as far as it did when pierced or blocked (m)
  bool got_out_ = false;
  EmbeddedPoint end_;
  std::uint64_t next_id_ = 0;
};

}  // namespace sutura::suturing
