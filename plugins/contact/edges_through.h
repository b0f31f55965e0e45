// How deep edges of a surface stick through triangles of another one, or of itself.
#pragma once

#include "surface_mark.h"

namespace sutura::contact {

class EdgesThrough {
 public:
  /// The largest depth at the guess, if it is more than `seen`; else 0 (m). It searches only where
  /// what has moved since the last search may have brought it there.
  Real deepest(const MovingSurface& edges, const MovingSurface& faces, Real seen);

 private:
  static Real search(const MovingSurface& edges, const MovingSurface& faces);

  SurfaceMark edges_, faces_;
  Real last_ = 0;  ///< what the last search found (m)
};

}  // namespace sutura::contact
