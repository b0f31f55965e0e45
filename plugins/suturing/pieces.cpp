#include "pieces.h"

#include "sutura/archive.h"
#include "sutura/cuttable.h"

namespace sutura::suturing {

Pieces::Pieces(const CurveBody& thread) : thread_(thread) {
  if (dynamic_cast<const Cuttable*>(&thread) != nullptr)
    cuttable_ = dynamic_cast<const SegmentedCurve*>(&thread);
}

void Pieces::look() {
  if (cuttable_ == nullptr) return;
  cuttable_->segments(Configuration::current, beams_);
  gaps_.reserve(beams_.size());
  gaps_.clear();
  for (const CurveSegment& beam : beams_) {
    if (!beam.cut) continue;
    if (!gaps_.empty() && gaps_.back().high == beam.from)
      gaps_.back().high = beam.to;
    else
      gaps_.push_back({beam.from, beam.to});
  }
}

Pieces::Piece Pieces::of(Real s) const {
  Piece piece{0, thread_.length()};
  for (const Piece& gap : gaps_) {
    if (s <= gap.low) {
      piece.high = gap.low;
      break;
    }
    if (s < gap.high) return {s, s};
    piece.low = gap.high;
  }
  return piece;
}

void Pieces::archive(Archive& a) {
  a.list("gaps", gaps_, [](Archive& each, Piece& gap) {
    each("low", gap.low);
    each("high", gap.high);
  });
}

}  // namespace sutura::suturing
