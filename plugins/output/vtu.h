// VTK's XML format for unstructured grids (.vtu), and its index over time (.pvd).
//
// Arrays are "binary" in VTK's sense: base64 of little-endian numbers, compressed by zlib, in the
// place where the array is declared. ParaView, VTK and meshio read it. The format has no way to say
// once what does not change from file to file; compressed, it is a small part.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "output_file.h"
#include "sutura/body.h"

namespace sutura::output {

/// RFC 4648, with padding.
std::string base64(std::span<const unsigned char> bytes);

/// What a cell of a .vtu is made of; the values are VTK's.
enum class VtkCell : std::uint8_t { vertex = 1, line = 3, tetrahedron = 10 };

/// One grid. Fields must have components * (points or cells) values.
struct VtuGrid {
  VtkCell cell = VtkCell::vertex;
  std::vector<Vec3> points;
  std::vector<Index> connectivity;
  std::vector<BodyGeometry::Field> fields;
  /// Whole numbers about the grid as a whole: name and value.
  std::vector<std::pair<std::string, int>> constants;
};

int nodes_per_cell(VtkCell cell);

/// The text that says which points make up which cell, of the last grid written: as long as cells
/// are the same, as those of a tissue are, it is not packed again.
struct VtuCells {
  VtkCell cell = VtkCell::vertex;
  std::vector<Index> connectivity;
  std::string text;
};

/// The text of the file. `time` (s) is stored as the field TimeValue that ParaView shows.
std::string vtu_text(const VtuGrid& grid, Real time, VtuCells& cells);

/// What keeps the grid from being written (a field of wrong length, an index out of range), in a
/// sentence, or empty.
std::string check(const VtuGrid& grid);

/// A .pvd: the list of files of one thing over time. Well-formed after every `add`.
class PvdFile {
 public:
  std::string open(const std::filesystem::path& file);
  /// Goes on after the first `end` bytes.
  std::string resume(const std::filesystem::path& file, std::int64_t end);
  std::int64_t end() const { return file_.end(); }
  /// `dataset` is relative to the folder of the .pvd.
  std::string add(Real time, const std::filesystem::path& dataset);
  std::string close() { return file_.close(); }

 private:
  OutputFile file_;
};

}  // namespace sutura::output
