// Which knot a thread has in it, whose ends go on for ever: from its drawing, by the Jones
// polynomial.
//
// The polynomial of throws upon each other is the product of those of the throws; a throw of one,
// two or three turns closes to the torus knot of 3, 5 or 7 crossings, right- or left-handed (Jones
// 1987). So a square knot and a granny are told apart, and throws are counted; their order is not
// seen.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "sutura/types.h"

namespace sutura::contact {

struct KnotType {
  bool is_knot = false;
  bool is_known = false;  ///< what follows but the determinant is known
  Index throws = 0;       ///< torus knots one after another
  Index left = 0;         ///< of these left-handed
  Index crossings = 0;    ///< 3 for a throw of one turn, 5 of two, 7 of three
  Real determinant = 1;   ///< |Alexander polynomial at -1|; of a throw, its crossings
  bool operator==(const KnotType&) const = default;
};

/// Jones polynomial at t = exp(i angle) of an open line that crosses itself at most some fifty
/// times in a drawing; by Kauffman's bracket (1987), strands cut open crossing by crossing. Nothing
/// where that takes too long. The ends of the line must be outside of all of it.
std::optional<std::complex<Real>> jones(const std::vector<Vec3>& line, Real angle);

/// With fewer points: none of those left out is further than `off` (m) from what is left. Where
/// strands are further apart than twice that, it is the same knot.
std::vector<Vec3> simplified(const std::vector<Vec3>& line, Real off);

KnotType knot_type(const std::vector<Vec3>& line);

}  // namespace sutura::contact
