// Reads a tetrahedral mesh: Gmsh MSH 2.2 and 4.1, VTK legacy, VTU.
//
// A file is not trusted: every count is compared with what the rest of the file can hold before
// anything is allocated, every index is checked, and the first fault ends the reading with the line
// (or byte) and a sentence that says what was expected.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "mesh_data.h"
#include "sutura/file_cursor.h"

namespace sutura::tissue {

struct MeshReading {
  MeshData mesh;
  std::optional<FileProblem> problem;  ///< if set, the mesh is empty
  bool ok() const { return !problem; }
};

/// Largest file read: 2 GiB, some 20 million tets.
inline constexpr std::uintmax_t max_mesh_bytes = std::uintmax_t{1} << 31;

/// The format is taken from the first bytes, not from the extension.
MeshReading read_mesh(const std::filesystem::path& file);
MeshReading read_mesh_text(std::string_view bytes);

}  // namespace sutura::tissue
