// What a thread presses on the wall of its channel: the friction of `lateral_share`.
#include <algorithm>
#include <array>

#include "suture_path.h"

namespace sutura::suturing {
namespace {

// In edges of the element at a sample: so far along the thread, either way, its force is spread.
constexpr Real spread_over = 2;

/// Mean length of the edges of the element at this point of the tissue (m).
Real edge_length(const SolidBody& tissue, const EmbeddedPoint& at) {
  std::array<Vec3, 4> corner;
  Real sum = 0;
  for (std::size_t i = 0; i < corner.size(); ++i) {
    EmbeddedPoint only{.element = at.element, .weights = {}};
    only.weights[i] = 1;
    corner[i] = tissue.position(only, Configuration::rest);
    for (std::size_t k = 0; k < i; ++k) sum += (corner[i] - corner[k]).norm();
  }
  return sum / 6;
}

}  // namespace

/// The force across the thread by which its tension turns it where a crossing stands for it.
Vec3 SuturePath::turned_by_tension(const Crossing& c) const {
  constexpr Configuration now = Configuration::current;
  const Real low = std::max(c.share.low, Real(0)), high = std::min(c.share.high, thread_->length());
  if (!(low < high)) return Vec3::Zero();
  const Vec3 along = c.axes.row(0);
  const Vec3 turn = thread_->tangent(high, now) - thread_->tangent(low, now);
  return -thread_->tension(c.abscissa) * (turn - turn.dot(along) * along);
}

/// What each sample presses is not what the thread presses there. A channel that a needle has made
/// in a mesh has bends of a few degrees where it goes from element to element. A thread that is
/// stiff against bending bears on them, this way and that way, and the more the closer the samples
/// are; the elements do not feel it. Over some elements such forces cancel. What is spread so is
/// what is left where the tension has turned the thread, which may wind to and fro. It turns with
/// the thread as it is spread.
void SuturePath::find_pressing(const SolvedBlocks& solved) {
  pressing_.assign(sample_crossings_, Vec3::Zero());
  for (const LateralBlock& b : blocks_) {
    const Crossing& c = crossings_[b.crossing];
    const bool is_end = b.crossing == sample_crossings_;
    const std::size_t at = is_end ? sample_crossings_ - 1 : b.crossing;
    Vec3 force = c.axes.bottomRows<2>().transpose() * solved.lambda(b.block);
    if (!is_end) {
      const Vec3 turned = turned_by_tension(c);
      pressing_[at] += turned;
      force -= turned;
    }
    // Not beyond what of the thread is in this bite.
    std::size_t first = at, last = at;
    while (channel_->is_joined(first)) --first;
    while (last + 1 < sample_crossings_ && channel_->is_joined(last + 1)) ++last;
    const PathSample& sample = channel_->samples()[at];
    const Real s = is_end ? 0 : sample.abscissa;
    const Real reach = spread_over * edge_length(*tissue_, is_end ? channel_->end() : sample.at);
    const Real low = std::max(s - reach, crossings_[last].share.low);
    const Real high = std::min(s + reach, crossings_[first].share.high);
    if (!(high > low)) pressing_[at] += force;
    for (std::size_t i = first; i <= last; ++i) {
      const Crossing& other = crossings_[i];
      const Real common = std::min(high, other.share.high) - std::max(low, other.share.low);
      if (!(common > 0)) continue;
      const Vec3 from = c.axes.row(0), to = other.axes.row(0);
      pressing_[i] += common / (high - low) * (Quat::FromTwoVectors(from, to) * force);
    }
  }
}

void SuturePath::keep_pressing() {
  for (std::size_t i = 0; i < sample_crossings_; ++i)
    channel_->sample(i).lateral_force = pressing(i);
}

}  // namespace sutura::suturing
