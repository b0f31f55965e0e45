// The shape of a thread that nothing pulls at: curvature and torsion along it, from attributes or
// from a CSV file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sutura/types.h"

namespace sutura::thread {

/// From `from` on, until the next piece begins, the thread is a helix at rest (an arc, where it has
/// no torsion; straight, where it has no curvature either).
struct RestPiece {
  Real from = 0;            ///< m, from the needle's end
  Real curvature = 0;       ///< 1/m, about minus z of the section
  Real torsion = 0;         ///< 1/m
  Real side_curvature = 0;  ///< 1/m, about y of the section
};

class RestShape {
 public:
  /// Straight.
  RestShape() : RestShape(std::vector<RestPiece>(1)) {}
  /// Pieces in ascending order, the first of them from 0.
  explicit RestShape(std::vector<RestPiece> pieces);

  /// At distance s, if the thread leaves `origin` along its x axis; it bends about minus z.
  Pose at(const Pose& origin, Real s) const;

 private:
  std::vector<RestPiece> pieces_;
  std::vector<Pose> starts_;  ///< of the pieces, seen from the first
};

/// Columns s, curvature, torsion and side_curvature with units in the header, `s [mm], curvature
/// [1/m], torsion [1/m]`; the last two may be left out. A row holds from its s on. What is wrong
/// goes to `error`, with the line.
std::vector<RestPiece> read_rest_shape(const std::filesystem::path& file, int& line,
                                       std::string& error);

}  // namespace sutura::thread
