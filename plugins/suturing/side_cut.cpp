// A thread that cuts sideways through tissue takes its channel along, and its mouths along the
// surface.
#include <algorithm>

#include "channel.h"

namespace sutura::suturing {
namespace {

// Along the thread, for where it goes through the surface: so far at least, in spacings of samples.
constexpr Real search_least = 2;

/// A thread that leans by an angle a, and goes sideways, goes through the surface tan a times as
/// far from there, along itself.
constexpr Real along_over_sideways = 4;

}  // namespace

/// The abscissa of the next mouth towards the end of the thread or towards its tip, or where the
/// piece of thread ends.
Real Channel::next_mouth(std::size_t i, bool to_end) const {
  const Pieces::Piece piece = piece_at(i);
  if (to_end) {
    for (std::size_t k = i; k-- > 0;)
      if (samples_[k].kind != PathSample::Kind::inner)
        return std::min(samples_[k].abscissa, piece.high);
    return piece.high;
  }
  for (std::size_t k = i + 1; k < passed_; ++k)
    if (samples_[k].kind != PathSample::Kind::inner)
      return std::max(samples_[k].abscissa, piece.low);
  return piece.low;
}

/// Where the thread at mouth i, seen `apart` from itself, goes through the surface, within `reach`
/// along it; and the sample is there on the thread. Or nothing.
std::optional<EmbeddedPoint> Channel::mouth_of(std::size_t i, const Vec3& apart, Real reach) {
  PathSample& mouth = samples_[i];
  const bool is_entry = mouth.kind == PathSample::Kind::entry;
  Real s = mouth.abscissa;
  Vec3 from = thread_.point(s, now) + apart;
  const bool outwards = tissue_.locate(from, now).has_value();
  const bool to_end = outwards == is_entry;
  const Real limit = next_mouth(i, to_end);
  const Real last = to_end ? std::min(s + reach, limit) : std::max(s - reach, limit);
  while (to_end ? s < last : s > last) {
    const Real step = search_step * spacing_;
    s = to_end ? std::min(s + step, last) : std::max(s - step, last);
    const Vec3 to = thread_.point(s, now) + apart;
    const Vec3 facing = outwards ? Vec3(to - from) : Vec3(from - to);
    if (const auto hit = tissue_.crossing(from, to, now, facing)) {
      mouth.abscissa = s + (to_end ? -1 : 1) * (to - hit->position).norm();
      return hit->at;
    }
    from = to;
  }
  return std::nullopt;
}

Real Channel::cut_to(std::size_t i, const Vec3& point) {
  PathSample& s = samples_[i];
  const Vec3 from = tissue_.position(s.at, now);
  const Pieces::Piece piece = piece_at(i);
  s.abscissa = thread_.closest_abscissa(point, s.abscissa, piece.low, piece.high, now);
  const Vec3 tangent = thread_.tangent(s.abscissa, now);
  std::optional<EmbeddedPoint> to;
  if (s.kind != PathSample::Kind::inner) {
    const Real reach = search_least * spacing_ + along_over_sideways * (point - from).norm();
    to = mouth_of(i, point - thread_.point(s.abscissa, now), reach);
    // At an edge of the tissue it stays on the surface, as long as it reaches.
    if (!to)
      if (const auto foot = tissue_.closest_surface(point, thread_.radius(0), now)) to = foot->at;
  }
  if (!to) to = tissue_.locate(point, now);
  s.cut_out = !to;
  if (to) s.at = *to;
  const Vec3 way = (to ? tissue_.position(s.at, now) : point) - from;
  return (way - way.dot(tangent) * tangent).norm();
}

Real Channel::cut_end_to(const Vec3& point) {
  const Vec3 from = tissue_.position(end_, now);
  end_ = embed(point);
  return (tissue_.position(end_, now) - from).norm();
}

/// Where a thread leans, a mouth that goes along the surface passes samples: they are outside now
/// because the bite begins or ends further on, not because it is cut open.
void Channel::drop_passed_by() {
  for (std::size_t i = 0; i < passed_; ++i) {
    const PathSample& mouth = samples_[i];
    if (mouth.cut_out) continue;
    if (mouth.kind == PathSample::Kind::entry) {
      for (std::size_t k = i + 1; k < passed_ && is_joined(k) && samples_[k].cut_out; ++k) {
        if (samples_[k].abscissa < mouth.abscissa) break;
        samples_[k].passed_by = true;
      }
    } else if (mouth.kind == PathSample::Kind::exit) {
      for (std::size_t k = i; k > 0 && is_joined(k) && samples_[k - 1].cut_out; --k) {
        if (samples_[k - 1].abscissa > mouth.abscissa) break;
        samples_[k - 1].passed_by = true;
      }
    }
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < passed_; ++i)
    if (!samples_[i].passed_by) samples_[kept++] = samples_[i];
  samples_.erase(samples_.begin() + static_cast<std::ptrdiff_t>(kept),
                 samples_.begin() + static_cast<std::ptrdiff_t>(passed_));
  passed_ = kept;
}

/// What is left of a bite that has been cut open goes as far as the thread is in the tissue.
void Channel::make_mouth(std::size_t i, PathSample::Kind kind) {
  samples_[i].kind = kind;
  if (const auto mouth = mouth_of(i, Vec3::Zero(), search_least * spacing_))
    samples_[i].at = *mouth;
}

void Channel::drop_cut_out() {
  const auto is_out = [](const PathSample& s) { return s.cut_out; };
  if (std::none_of(samples_.begin(), samples_.end(), is_out)) return;
  const bool was_open = tip_inside();
  drop_passed_by();
  std::vector<PathSample> rest;
  rest.reserve(samples_.capacity());
  bool is_open = false;
  for (std::size_t i = 0; i < passed_;) {
    // A run of samples of one stretch of thread, none of them cut out.
    std::size_t end = i;
    bool has_inner = false;
    for (; end < passed_ && !samples_[end].cut_out; ++end) {
      if (end > i && !is_joined(end)) break;
      has_inner = has_inner || samples_[end].kind == PathSample::Kind::inner;
    }
    if (end == i) {
      ++i;
      continue;
    }
    // What it was joined to has been cut out.
    const bool begins_here = is_joined(i), ends_here = end < passed_ && is_joined(end);
    if (!(begins_here || ends_here) || (has_inner && end - i > 1)) {
      PathSample &first = samples_[i], &last = samples_[end - 1];
      if (begins_here) make_mouth(i, PathSample::Kind::entry);
      if (ends_here) make_mouth(end - 1, PathSample::Kind::exit);
      rest.insert(rest.end(), &first, &last + 1);
      is_open = was_open && end == passed_;
    }
    i = end;
  }
  const std::size_t passed = rest.size();
  // What a retracting tip has left goes on from the open bite.
  if (is_open == was_open)
    rest.insert(rest.end(), samples_.begin() + static_cast<std::ptrdiff_t>(passed_),
                samples_.end());
  samples_.swap(rest);
  passed_ = passed;
}

}  // namespace sutura::suturing
