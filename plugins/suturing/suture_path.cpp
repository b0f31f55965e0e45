#include "suture_path.h"

#include <algorithm>
#include <limits>

#include "puncture_law.h"
#include "sutura/archive.h"
#include "sutura/laws/bilateral.h"
#include "sutura/laws/turning_force.h"
#include "sutura/scene.h"
#include "sutura/units.h"

namespace sutura::suturing {
namespace {

constexpr std::uint64_t end_of_channel = (1ull << 39);  // no sample id comes near it
constexpr std::uint64_t turning = (1ull << 38);  // names of forces that turn are from here on

constexpr Real matters = 1e-3;  // of the largest force: how a smaller one turns is left out

// In units of the spacing of samples.
constexpr Real too_close_to_tip = 0.3;  // rows that would repeat those of the end
constexpr Real shortest = 0.1;  // length that a sample stands for at least, so that its wall is
                                // never softer than ten times the others

// Sine of the angle from which on a needle points straight at a surface: its tip has no way along.
constexpr Real straight_at = 1e-3;

/// Unit vector across `tangent`, as near to `v` as can be.
Vec3 across_to(const Vec3& tangent, const Vec3& v) {
  constexpr Real clear = 0.1;
  const Vec3 across = v - tangent.dot(v) * tangent;
  return across.norm() > clear ? across.normalized() : tangent.unitOrthogonal();
}

}  // namespace

void SuturePath::describe(Describe<SuturePath>& d) {
  d.summary(
      "Holds needle and thread in the channel they have made in a tissue: samples fixed in the "
      "tissue, created as the tip "
      "advances and left as it retracts, or there from the start (`sewn`); free along the thread, "
      "bilateral across it.");
  d.theory(
      "At each sample P_j of the channel the thread has an abscissa s_j, found in order along the "
      "path at the present guess of the\n"
      "end of the step. Two rows hold delta = N^T (x_thread(s_j) - x_tissue(P_j)) = 0 with N "
      "normal "
      "to the thread there (paper, section 4.4).\n"
      "With a `strength` the force of a sample is at most that times the length l it stands for. "
      "There the thread cuts on: P_j goes along with it, and takes strength times l times its way "
      "of work. The elements stay as they are: the cut is one of the channel, not of the mesh.");
  d.link("thread", &SuturePath::thread_, "Needle and thread.");
  d.link("tissue", &SuturePath::tissue_, "What they pass through.");
  d.attribute("spacing", &SuturePath::spacing_, "m", between(1e-6, 1e3),
              "Distance between samples along the channel.");
  d.attribute("wall_compliance", &SuturePath::wall_compliance_, "1/Pa", between(0, 1e6),
              "Gap that opens per lateral load on a length of channel, (m) per (N/m). Samples "
              "closer than the elements say "
              "the same thing several times; without any give their forces would have no bound.");
  d.attribute("strength", &SuturePath::strength_, "N/m", between(0, 1e9),
              "Load across the thread, per length of channel, at which it cuts sideways through "
              "the tissue; 0: it never does.");
  d.attribute(
      "sewn", &SuturePath::sewn_,
      "Whether the thread begins sewn: where it is laid through the tissue, its channel is "
      "there from the start, bite after bite. Else there is none before a needle makes it.");
  d.output(
      "inserted_length", "m", "Length of needle and thread inside the tissue.",
      [](const SuturePath& p) { return p.channel_ ? p.channel_->inserted_length() : Real(0); });
  d.output("samples", "1", "Samples on the thread.",
           [](const SuturePath& p) { return p.channel_ ? Real(p.channel_->passed()) : Real(0); });
  d.output("tip_depth", "m", "Depth of the tip along the channel; 0 outside.",
           [](const SuturePath& p) {
             return p.channel_ ? std::max(p.channel_->tip_depth(), Real(0)) : Real(0);
           });
  d.output("state", "", "Where the tip is: outside, cutting (at the end of the channel) or inside.",
           [](const SuturePath& p) -> std::string {
             if (!p.channel_ || !p.channel_->tip_inside()) return "outside";
             return p.channel_->tip_at_end() ? "cutting" : "inside";
           });
  d.output("entry_abscissa", "m", "Abscissa of the thread at the first sample: what has gone in.",
           [](const SuturePath& p) {
             return p.channel_ && p.channel_->passed() > 0 ? p.channel_->samples().front().abscissa
                                                           : Real(0);
           });
  d.output("lateral_force", "N", "Largest force across the thread over the samples.",
           [](const SuturePath& p) { return p.lateral_force_; });
  d.output("lateral_gap", "m", "Largest distance between the thread and its channel.",
           [](const SuturePath& p) { return p.lateral_gap_; });
  d.output("cut", "m^2", "Area that the thread has cut sideways through the tissue.",
           [](const SuturePath& p) { return p.cut_; });
}

void SuturePath::initialise(Setup& setup) {
  source_id_ = setup.source_id;
  // All of the thread may end up in the tissue, and each sample is three rows of a dense system.
  constexpr Index most_samples = 5000;
  if (thread_->length() / spacing_ > most_samples)
    return setup.error(*this, "spacing: a thread of " + format_real(thread_->length()) +
                                  " m would make more than " + std::to_string(most_samples) +
                                  " samples; expected at least " +
                                  format_real(thread_->length() / most_samples) + " m");
  channel_.emplace(*thread_, *tissue_, spacing_);
  crossings_.reserve(256);
  blocks_.reserve(256);
  pressing_.reserve(256);
  if (sewn_) sew(setup);
}

/// Again, because the nodes of the thread have moved to where they are held. The first time told a
/// Contact what is inside.
void SuturePath::ready(Setup& setup) {
  channel_->look_for_cuts();  // makes room for the beams
  if (sewn_) return sew(setup);
  const auto& all = setup.scene->components();
  if (std::none_of(all.begin(), all.end(),
                   [](const Component* c) { return c->info().name == "Puncture"; }))
    setup.warning(*this,
                  "nothing opens the tissue: without a Puncture the needle goes through it as if "
                  "it were not there");
}

void SuturePath::sew(Setup& setup) {
  if (thread_->wants_settling() || tissue_->wants_settling())
    return setup.error(*this,
                       "sewn: thread and tissue begin as they are laid out; leave out 'settle'");
  const std::string wrong = channel_->sew();
  if (!wrong.empty()) setup.error(*this, "sewn: the thread is to lie in the tissue, but " + wrong);
}

void SuturePath::archive(Archive& a) {
  channel_->archive(a);
  a("lateral_force", lateral_force_);
  a("lateral_gap", lateral_gap_);
  a("cut", cut_);
}

Crossing SuturePath::cross(const EmbeddedPoint& at, std::uint64_t id, Real before,
                           const Vec3& across, Real low, Real high) const {
  constexpr Configuration now = Configuration::current;
  Crossing c;
  c.id = id;
  c.position = tissue_->position(at, now);
  c.abscissa = thread_->closest_abscissa(c.position, std::max(before, low), low, high, now);
  const Vec3 tangent = thread_->tangent(c.abscissa, now);
  // Forces are known by their components: with axes that turn otherwise than the thread does, they
  // would turn from guess to guess, and otherwise in a scene that is turned.
  const Vec3 tangent_before = thread_->tangent(before, Configuration::start);
  c.axes.row(0) = tangent;
  c.axes.row(1) = across_to(tangent, shortest_rotation(tangent_before, tangent) * across);
  c.axes.row(2) = tangent.cross(c.axes.row(1));
  c.gap = c.axes * (thread_->point(c.abscissa, now) - c.position);
  c.gap.x() += before - c.abscissa;
  thread_->jacobian(c.abscissa, c.thread);
  tissue_->jacobian(at, c.tissue);
  return c;
}

void SuturePath::detect(const StepContext& context) {
  blocked_by_.reset();
  if (context.pass == 0) channel_->look_for_cuts();
  tip_let_out_ = false;
  const Channel& channel = *channel_;
  sample_crossings_ = channel.passed();
  crossings_.resize(sample_crossings_);
  // From the tip backwards: abscissae grow in the order in which the channel was entered, so each
  // search is bounded by the one before it and cannot jump to another loop of the thread.
  Real low = 0;
  for (std::size_t i = channel.passed(); i-- > 0;) {
    const PathSample& s = channel.samples()[i];
    const Pieces::Piece piece = channel.piece_at(i);
    crossings_[i] = cross(s.at, s.id, s.abscissa, s.across, std::max(low, piece.low), piece.high);
    crossings_[i].sample = i;
    crossings_[i].share = channel.share_of(i);
    low = crossings_[i].abscissa;
  }
  // The end of the channel is where the tip was; the section that is there now has to follow it, or
  // a curved needle would be led along its tangent.
  if (!channel.tip_at_end()) return;
  const Vec3 across = thread_->frame(0, Configuration::start).rotation * Vec3::UnitY();
  crossings_.push_back(cross(channel.end(), end_of_channel, 0, across, 0, thread_->length()));
}

/// So close that its rows would repeat those of the end of the channel.
bool SuturePath::is_at_tip(const Crossing& c) const {
  return channel_->samples()[c.sample].abscissa < too_close_to_tip * spacing_;
}

/// What the end of the channel stands for, of the length from the tip to the sample beside it (m).
Real SuturePath::share_of_end() const {
  const Crossing& beside = crossings_[sample_crossings_ - 1];
  return is_at_tip(beside) ? beside.share.high : channel_->samples()[beside.sample].abscissa / 2;
}

Vec3 SuturePath::way_along_block(const ConstraintBuilder& builder) const {
  if (!blocked_by_) return Vec3::Zero();
  if (builder.known_mode(blocked_by_->key, PunctureLaw::pressing) == PunctureLaw::penetrated)
    return Vec3::Zero();
  const Vec3 forward = -thread_->tangent(0, Configuration::current), &n = blocked_by_->normal;
  const Vec3 along = forward - forward.dot(n) * n;
  return along.norm() > straight_at ? along.normalized() : Vec3::Zero();
}

/// Force across the thread at a sample, in the pass before (N).
Vec3 SuturePath::known_force(const Crossing& c, const ConstraintBuilder& builder) const {
  const Key key = make_key(source_id_, c.id);
  return c.axes.row(1) * builder.known_force(key) + c.axes.row(2) * builder.known_force(key, 1);
}

/// The force across the thread turns with it, as it slides on round a bend and as it leans. Rows do
/// not say that, and where tissue or thread are softer, passes would be slow or go to and fro. So
/// it is said beside them, about the guess: without force there, and gone with the pass.
void SuturePath::add_turning_force(const StepContext& context, const Crossing& c, const Vec3& force,
                                   ConstraintBuilder& builder) const {
  const Real reach = 2 * thread_->radius(c.abscissa);
  const Pieces::Piece piece = channel_->piece_at(c.sample);  // what is beyond a cut turns nothing
  const Real low = std::max(c.abscissa - reach, piece.low);
  const Real high = std::min(c.abscissa + reach, piece.high);
  if (!(low < high)) return;
  constexpr Configuration now = Configuration::current;
  const Vec3 turn = thread_->tangent(high, now) - thread_->tangent(low, now);
  const Real arm = high - low, size = force.norm();
  // A name for this pass only: what it carried is not taken on.
  const std::uint64_t name = turning | (c.id << 8) | static_cast<std::uint64_t>(context.pass & 255);
  const BlockId block = builder.add<TurningForce>(
      make_key(source_id_, name), {.stiffness = -force.dot(turn) / arm, .coupling = size / arm},
      BlockVector<2>::Zero());
  Directions along = Directions::Zero(2, 3), towards = along;
  along.row(0) = c.axes.row(0);
  towards.row(1) = force / size;
  builder.couple(block, *thread_, along, c.thread, c.position);
  builder.couple(block, *tissue_, -along, c.tissue, c.position);
  PointJacobian end;
  thread_->jacobian(high, end);
  builder.couple(block, *thread_, towards, end, c.position);
  thread_->jacobian(low, end);
  builder.couple(block, *thread_, -towards, end, c.position);
}

void SuturePath::build(const StepContext& context, ConstraintBuilder& builder) {
  blocks_.clear();
  way_along_ = way_along_block(builder);
  const Real strength = strength_ > 0 ? strength_ : std::numeric_limits<Real>::infinity();
  const bool hold_end = crossings_.size() > sample_crossings_ && !tip_blocked();
  const Real end_share = hold_end ? share_of_end() : 0;
  Real largest = 0;
  for (std::size_t i = 0; i < sample_crossings_; ++i)
    largest = std::max(largest, known_force(crossings_[i], builder).norm());
  for (std::size_t i = 0; i < crossings_.size(); ++i) {
    const Crossing& c = crossings_[i];
    const bool is_end = i == sample_crossings_;
    if (is_end && !hold_end) break;
    // A sample made a moment ago is where the end is. The rows of the end hold that section
    // already.
    if (!is_end && hold_end && is_at_tip(c)) continue;
    const Real least = shortest * spacing_;
    const Real compliance =
        wall_compliance_ / (is_end ? spacing_ : std::max(c.share.high - c.share.low, least));
    // The end bears what the samples beside it would, and they do not.
    const Real length =
        std::max(is_end ? end_share : c.share.high - std::max(c.share.low, end_share), least);
    const BlockId block = builder.add<Bilateral<2>>(
        make_key(source_id_, c.id), {.compliance = compliance, .cap = strength * length},
        BlockVector<2>(c.gap.tail<2>()));
    const Directions across = c.axes.bottomRows<2>();
    builder.couple(block, *thread_, across, c.thread, c.position);
    builder.couple(block, *tissue_, -across, c.tissue, c.position);
    blocks_.push_back({block, i, compliance, length});
    if (is_end) continue;
    const Vec3 force = known_force(c, builder);
    if (force.norm() > matters * largest) add_turning_force(context, c, force, builder);
  }
}

/// Bites follow each other along the path: each from the sample of its entry to that of its exit,
/// or as far as the thread goes.
void SuturePath::inside(std::vector<Stretch>& out) const {
  out.clear();
  const std::size_t samples = channel_->passed();
  for (std::size_t i = 0; i < samples; ++i) {
    const PathSample& s = channel_->samples()[i];
    const Real guess = i < sample_crossings_ ? crossings_[i].abscissa : s.abscissa;
    const auto [low, high] = std::minmax(s.abscissa, guess);
    const Channel::Share share = channel_->share_of(i);
    if (!channel_->is_joined(i)) out.push_back({low, std::max(high, share.high)});
    out.back().low = std::min({out.back().low, low, share.low});
  }
}

/// A thread that is further from its channel than a needle is thick is not in it any more. Nor is a
/// tip that a surface holds from the inside, if it is as far along that surface from the end.
std::string SuturePath::fault() const {
  const Real far = 2 * std::max(thread_->radius(0), thread_->radius(thread_->length()));
  if (lateral_gap_ > far) return "the thread has left its channel";
  if (!(stray_ > far)) return {};
  return "the tip, held by a surface from the inside, has gone along it without cutting its way";
}

/// How far the tip is from the end of its channel, along what holds it; on the way back from there
/// it is in its channel (m).
Real SuturePath::stray() const {
  if (!tip_blocked() || way_along_.isZero(0) || !channel_->tip_inside()) return 0;
  constexpr Configuration now = Configuration::current;
  const Vec3& n = blocked_by_->normal;
  const Vec3 apart = thread_->point(0, now) - tissue_->position(channel_->end(), now);
  const Vec3 flat = apart - apart.dot(n) * n;
  return (flat - std::min(flat.dot(way_along_), Real(0)) * way_along_).norm();
}

/// Where the wall is at its limit, the channel goes along with the thread.
void SuturePath::cut(const SolvedBlocks& solved) {
  for (const LateralBlock& b : blocks_) {
    if (solved.mode(b.block) != Bilateral<2>::capped) continue;
    const Crossing& c = crossings_[b.crossing];
    const BlockVector<2> force = solved.lambda(b.block);
    const Vec3 way = c.axes.bottomRows<2>().transpose() * (c.gap.tail<2>() + b.compliance * force);
    if (b.crossing < sample_crossings_) {
      cut_ += channel_->cut_to(c.sample, c.position + way) * b.length;
      continue;
    }
    cut_ += channel_->cut_end_to(c.position + way) * b.length;
    const Crossing& beside = crossings_[sample_crossings_ - 1];
    if (is_at_tip(beside)) channel_->cut_to(beside.sample, beside.position + way);
  }
  channel_->drop_cut_out();
}

void SuturePath::commit(const StepContext&, const SolvedBlocks& solved) {
  lateral_force_ = 0;
  for (const LateralBlock& b : blocks_)
    lateral_force_ = std::max(lateral_force_, solved.lambda(b.block).norm());
  for (std::size_t i = 0; i < sample_crossings_; ++i)
    channel_->sample(i).across = crossings_[i].axes.row(1);
  find_pressing(solved);
  keep_pressing();
  if (strength_ > 0) cut(solved);
  channel_->update(tip_blocked(), way_along_, tip_let_out_);
  lateral_gap_ = 0;
  for (std::size_t i = 0; i < channel_->passed(); ++i) {
    const PathSample& s = channel_->samples()[i];
    const Vec3 gap = thread_->point(s.abscissa, Configuration::current) -
                     tissue_->position(s.at, Configuration::current);
    lateral_gap_ = std::max(lateral_gap_, gap.norm());
  }
  stray_ = stray();
  sample_crossings_ = 0;  // of the step that is over
}

}  // namespace sutura::suturing
