// Reads a surface of triangles: OBJ, STL (text and binary), PLY (text and binary).
//
// A file is not trusted: counts are compared with what the rest of the file can hold, every index
// is checked, and the first fault ends the reading with its line and what was expected.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "sutura/file_cursor.h"
#include "triangle_mesh.h"

namespace sutura::contact {

struct TriangleReading {
  TriangleData data;
  std::optional<FileProblem> problem;  ///< if set, there are no data
};

/// Largest file read: some five million triangles.
inline constexpr std::uintmax_t max_triangle_bytes = std::uintmax_t{1} << 28;

/// The format is taken from the first bytes, not from the extension.
TriangleReading read_triangles(const std::filesystem::path& file);
TriangleReading read_triangle_text(std::string_view bytes);

// The readers, one per format; each throws FileProblem.
TriangleData read_obj(FileCursor& in);
TriangleData read_stl(FileCursor& in);
TriangleData read_stl_binary(std::string_view bytes);
TriangleData read_ply(FileCursor& in);

}  // namespace sutura::contact
