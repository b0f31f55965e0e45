// The pieces of a thread: what of it is one, between its ends and where it has been cut or torn.
#pragma once

#include <vector>

#include "sutura/geometry/curve_segments.h"

namespace sutura {
class Archive;
}

namespace sutura::suturing {

class Pieces {
 public:
  explicit Pieces(const CurveBody& thread);

  /// Looks where the thread is cut now.
  void look();

  struct Piece {
    Real low = 0;   ///< abscissae of its ends (m); that of the tip begins at 0
    Real high = 0;  ///< that of the end of the thread ends at its length
    bool ends_at(Real s) const { return s >= high || (low > 0 && s <= low); }
  };
  /// The piece of which s is a part; where a cut beam is, one without length.
  Piece of(Real s) const;
  void archive(Archive& archive);

 private:
  const CurveBody& thread_;
  const SegmentedCurve* cuttable_ = nullptr;  ///< the thread, if it can be cut
  std::vector<CurveSegment> beams_;           ///< at the last look
  std::vector<Piece> gaps_;                   ///< beams that are cut, by growing abscissa
};

}  // namespace sutura::suturing
