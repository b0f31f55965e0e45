// Key frames from a CSV file: one header line that names columns and units, one line per key.
//
//   t [s], x [mm], y [mm], z [mm], rx [deg], ry [deg], rz [deg]
//   0,     0, 0, 0,   0, 0, 0
//   1.5,   0, 0, 4,   0, 90, 0
//
// Columns may come in any order; t is required, the others are zero where left out; a column
// without a unit is in SI (s, m, rad). Empty lines and lines that start with '#' are skipped.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "key_frames.h"
#include "sutura/file_cursor.h"

namespace sutura::tools {

/// Bounds on what is read, so that a wrong file is refused instead of eating the memory.
inline constexpr std::size_t max_key_frame_bytes = std::size_t{64} << 20;
inline constexpr std::size_t max_file_problems = 20;

/// The keys of the text; empty whenever there is a problem.
std::vector<KeyFrame> parse_key_frames(std::string_view text, std::vector<FileProblem>& problems);

std::vector<KeyFrame> read_key_frames(const std::filesystem::path& file,
                                      std::vector<FileProblem>& problems);

}  // namespace sutura::tools
