#include "suture_path.h"

#include <algorithm>

#include "sutura/archive.h"
#include "sutura/laws/bilateral.h"

namespace sutura {
namespace {

constexpr std::uint64_t end_of_channel = (1ull << 39);  // no sample id comes near it

}  // namespace

void SuturePath::describe(Describe<SuturePath>& d) {
  d.summary(
      "Holds needle and thread in the channel they have made in a tissue: samples fixed in the "
      "tissue, created as the tip "
      "advances and left as it retracts, free along the thread, bilateral across it.");
  d.theory(
      "At each sample P_j of the channel the thread has an abscissa s_j, found in order along the "
      "path. Two rows hold\n"
      "delta = N^T (x_thread(s_j) - x_tissue(P_j)) = 0 with N normal to the thread (paper, section "
      "4.4). The rows use the\n"
      "material point expected at the sample at the end of the step (abscissa plus the slip of the "
      "step before), so that a\n"
      "curved needle slides without being straightened: the error left is kappa (slip - last "
      "slip)^2 / 2.");
  d.link("thread", &SuturePath::thread_, "Needle and thread.");
  d.link("tissue", &SuturePath::tissue_, "What they pass through.");
  d.attribute("spacing", &SuturePath::spacing_, "m", above(0),
              "Distance between samples along the channel.");
  d.attribute("wall_compliance", &SuturePath::wall_compliance_, "1/Pa", at_least(0),
              "Gap that opens per lateral load on a length of channel, (m) per (N/m). Samples "
              "closer than the elements say "
              "the same thing several times; without any give their forces would have no bound.");
  d.output(
      "inserted_length", "m", "Length of needle and thread inside the tissue.",
      [](const SuturePath& p) { return p.channel_ ? p.channel_->inserted_length() : Real(0); });
  d.output("samples", "1", "Samples on the thread.",
           [](const SuturePath& p) { return p.channel_ ? Real(p.channel_->passed()) : Real(0); });
  d.output("tip_depth", "m", "Depth of the tip along the channel; 0 outside.",
           [](const SuturePath& p) { return p.channel_ ? p.channel_->tip_depth() : Real(0); });
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
}

void SuturePath::initialise(Setup& setup) {
  source_id_ = setup.source_id;
  channel_.emplace(*thread_, *tissue_, spacing_);
  crossings_.reserve(256);
  blocks_.reserve(256);
}

void SuturePath::archive(Archive& a) {
  channel_->archive(a);
  a("lateral_force", lateral_force_);
  a("lateral_gap", lateral_gap_);
}

Crossing SuturePath::cross(const EmbeddedPoint& at, std::uint64_t id, Real abscissa,
                           Real slip) const {
  Crossing c;
  c.id = id;
  c.abscissa = std::clamp(abscissa + slip, Real(0), thread_->length());
  c.position = tissue_->position(at, Configuration::current);
  const Vec3 tangent = thread_->tangent(abscissa, Configuration::current);
  c.axes.row(0) = tangent;
  c.axes.row(1) = tangent.unitOrthogonal();
  c.axes.row(2) = tangent.cross(tangent.unitOrthogonal());
  c.free = c.axes * (thread_->point(c.abscissa, Configuration::free) -
                     tissue_->position(at, Configuration::free));
  c.free.x() -= c.abscissa - abscissa;
  thread_->jacobian(thread_->embed(c.abscissa), c.thread);
  tissue_->jacobian(at, c.tissue);
  return c;
}

void SuturePath::detect(const StepContext&) {
  crossings_.clear();
  tip_blocked_ = false;
  const Channel& channel = *channel_;
  for (std::size_t i = 0; i < channel.passed(); ++i) {
    const PathSample& s = channel.samples()[i];
    crossings_.push_back(cross(s.at, s.id, s.abscissa, s.slip));
    crossings_.back().sample = i;
    crossings_.back().share = channel.share_of(i);
  }
  sample_crossings_ = crossings_.size();
  if (channel.tip_at_end()) {
    // The end of the channel is where the tip is; the part of the needle that will be there at the
    // end of the step has to follow it, or a curved needle would be led along its tangent.
    const Real advance = std::max(channel.samples()[channel.passed() - 1].slip, Real(0));
    crossings_.push_back(cross(channel.end(), end_of_channel, 0, advance));
  }
}

void SuturePath::build(const StepContext&, ConstraintBuilder& builder) {
  blocks_.clear();
  const bool hold_end = crossings_.size() > sample_crossings_ && !tip_blocked_;
  for (std::size_t i = 0; i < crossings_.size(); ++i) {
    const Crossing& c = crossings_[i];
    const bool is_end = i == sample_crossings_;
    if (is_end && !hold_end) break;
    // A sample made a moment ago repeats the rows of the end: two rows for one thing fight each
    // other.
    if (!is_end && hold_end && channel_->samples()[c.sample].abscissa < 0.3 * spacing_) continue;
    const Real length = is_end ? spacing_ : c.share.high - c.share.low;
    const Real compliance = wall_compliance_ / std::max(length, 0.1 * spacing_);
    const BlockId block = builder.add<Bilateral<2>>(
        make_key(source_id_, c.id), {.compliance = compliance}, BlockVector<2>(c.free.tail<2>()));
    const Eigen::Matrix<Real, Eigen::Dynamic, 3> across = c.axes.bottomRows<2>();
    builder.couple(block, *thread_, across, c.thread, c.position);
    builder.couple(block, *tissue_, -across, c.tissue, c.position);
    blocks_.push_back({block, i});
  }
}

/// Tells the thread where the path will hold it in the next step, if all goes on as in this one.
void SuturePath::lead_thread(const SolvedBlocks& solved) {
  for (const LateralBlock& b : blocks_) {
    const Crossing& c = crossings_[b.crossing];
    const PathSample* s = channel_->find(c.id);
    if (s == nullptr) continue;  // the end of the channel, or left by a retracting tip
    // Through where the thread is now, not the sample: the wall gives, and a guide does not.
    const Vec3 moved = tissue_->position(s->at, Configuration::current) - c.position;
    thread_->expect({.abscissa = std::clamp(s->abscissa + s->slip, Real(0), thread_->length()),
                     .point = thread_->point(s->abscissa, Configuration::current) + moved,
                     .tangent = thread_->tangent(s->abscissa, Configuration::current),
                     .acted_at = c.abscissa,
                     .force = solved.force(b.block)});
  }
}

void SuturePath::commit(const StepContext&, const SolvedBlocks& solved) {
  lateral_force_ = 0;
  for (const LateralBlock& b : blocks_) {
    const Real force = solved.lambda(b.block).norm();
    lateral_force_ = std::max(lateral_force_, force);
    if (b.crossing < sample_crossings_) {
      channel_->sample(crossings_[b.crossing].sample).lateral_force = force;
    }
  }
  channel_->update();
  lead_thread(solved);
  lateral_gap_ = 0;
  for (std::size_t i = 0; i < channel_->passed(); ++i) {
    const PathSample& s = channel_->samples()[i];
    const Vec3 gap = thread_->point(s.abscissa, Configuration::current) -
                     tissue_->position(s.at, Configuration::current);
    lateral_gap_ = std::max(lateral_gap_, gap.norm());
  }
}

}  // namespace sutura
