// VTK legacy files (DATASET UNSTRUCTURED_GRID), versions 2 to 5, ASCII and (big-endian) binary.
#include "read_vtk.h"

#include <bit>
#include <set>

namespace sutura::tissue {

namespace {

/// Points, lines and faces, which a tetrahedral mesh may bring along (vtkCellType.h).
bool is_face_or_less(long long type) {
  static const std::set<long long> known{21, 22, 23, 28, 30, 34, 35, 36, 60,
                                         61, 62, 63, 68, 69, 70, 75, 76, 77};
  return (type >= 0 && type <= 9) || known.contains(type);
}

}  // namespace

void take_tets(const VtkCells& cells, int line, MeshData& mesh) {
  const auto points = static_cast<long long>(mesh.points.size());
  for (std::size_t c = 0; c < cells.types.size(); ++c) {
    if (cells.types[c] == vtk_quadratic_tetra)
      throw FileProblem{line, "cell " + std::to_string(c) +
                                  " is a second-order tetrahedron; save the mesh with order 1"};
    if (is_face_or_less(cells.types[c])) continue;
    // Left out, it would be a hole in the tissue.
    if (cells.types[c] != vtk_tetra)
      throw FileProblem{line, "cell " + std::to_string(c) + " is of type " +
                                  std::to_string(cells.types[c]) +
                                  ", no tetrahedron (type 10); expected tetrahedra only"};
    const long long first = cells.offsets[c];
    if (cells.offsets[c + 1] - first != 4)
      throw FileProblem{line, "cell " + std::to_string(c) + " is a tetrahedron with " +
                                  std::to_string(cells.offsets[c + 1] - first) +
                                  " points, expected 4"};
    Tet tet;
    for (std::size_t k = 0; k < 4; ++k) {
      const long long p = cells.connectivity[static_cast<std::size_t>(first) + k];
      if (p < 0 || p >= points)
        throw FileProblem{line, "cell " + std::to_string(c) + " uses point " + std::to_string(p) +
                                    ", expected 0 to " + std::to_string(points - 1)};
      tet[k] = static_cast<Index>(p);
    }
    int region = 0;
    if (!cells.region.empty()) {
      const double tag = cells.region[c];
      if (!(std::abs(tag) <= 2147483647.0) || tag != std::floor(tag))
        throw FileProblem{line,
                          "the region of cell " + std::to_string(c) + " is not a whole number"};
      region = static_cast<int>(tag);
    }
    mesh.tets.push_back(tet);
    mesh.region.push_back(region);
  }
}

namespace {

class LegacyReader {
 public:
  explicit LegacyReader(FileCursor& in) : in_(in) {}

  MeshData read() {
    in_.swap_bytes = std::endian::native == std::endian::little;
    header();
    while (!in_.peek().empty()) section();
    if (!has_points_) in_.fail("the file ends without POINTS");
    if (!has_cells_) in_.fail("the file ends without CELLS");
    if (cells_.types.empty()) in_.fail("the file ends without CELL_TYPES");
    take_tets(cells_, cells_line_, mesh_);
    return std::move(mesh_);
  }

 private:
  void header() {
    const std::string first(in_.rest_of_line());
    const std::size_t at = first.find("Version ");
    if (at == std::string::npos || first.size() < at + 9)
      in_.fail("expected '# vtk DataFile Version n.n' in the first line");
    version_ = first[at + 8] - '0';
    if (version_ < 2 || version_ > 5)
      in_.fail("only versions 2 to 5 of the VTK legacy format are read");
    in_.rest_of_line();  // title
    const std::string_view form = in_.word("ASCII or BINARY");
    if (form != "ASCII" && form != "BINARY")
      in_.fail("found '" + FileCursor::shortened(form) + "', expected ASCII or BINARY");
    binary_ = form == "BINARY";
    in_.keyword("DATASET");
    const std::string_view kind = in_.word("UNSTRUCTURED_GRID");
    if (kind != "UNSTRUCTURED_GRID")
      in_.fail("the data set is '" + FileCursor::shortened(kind) + "', expected UNSTRUCTURED_GRID");
  }

  void section() {
    const std::string key(in_.word("a keyword"));
    if (key == "POINTS")
      points();
    else if (key == "CELLS")
      cells();
    else if (key == "CELL_TYPES")
      cell_types();
    else if (key == "CELL_DATA")
      data(true);
    else if (key == "POINT_DATA")
      data(false);
    else if (key == "METADATA")
      metadata();
    else
      attribute(key);
  }

  // ---- values
  static std::size_t size_of(std::string_view type) {
    if (type == "double" || type == "long" || type == "unsigned_long" || type == "vtktypeint64" ||
        type == "vtktypeuint64" || type == "vtkIdType_64")
      return 8;
    if (type == "float" || type == "int" || type == "unsigned_int" || type == "vtktypeint32" ||
        type == "vtktypeuint32" || type == "vtkIdType")
      return 4;
    if (type == "short" || type == "unsigned_short") return 2;
    if (type == "char" || type == "unsigned_char" || type == "signed_char") return 1;
    return 0;
  }
  std::string type_word() {
    const std::string type(in_.word("a data type"));
    if (size_of(type) == 0)
      in_.fail("data type '" + FileCursor::shortened(type) + "' is not known");
    return type;
  }
  double real(const std::string& type, const char* what) {
    if (!binary_) return in_.real(what);
    if (type == "double") return in_.binary_real(what);
    if (type != "float") return static_cast<double>(whole(type, what));
    const float value = in_.binary<float>(what);
    if (!std::isfinite(value)) in_.fail_binary(std::string(what) + " is not a finite number");
    return value;
  }
  long long whole(const std::string& type, const char* what) {
    if (!binary_)
      return in_.integer<long long>(what, std::numeric_limits<long long>::min(),
                                    std::numeric_limits<long long>::max());
    switch (size_of(type)) {
      case 8:
        return in_.binary<std::int64_t>(what);
      case 4:
        return type == "unsigned_int" ? in_.binary<std::uint32_t>(what)
                                      : in_.binary<std::int32_t>(what);
      case 2:
        return type == "unsigned_short" ? in_.binary<std::uint16_t>(what)
                                        : in_.binary<std::int16_t>(what);
      default:
        return type == "unsigned_char" ? in_.binary<std::uint8_t>(what)
                                       : in_.binary<std::int8_t>(what);
    }
  }
  std::size_t bytes_each(const std::string& type) const { return binary_ ? size_of(type) : 2; }
  void begin_values() {
    if (binary_) in_.rest_of_line();
  }
  void skip_values(const std::string& type, std::size_t n) {
    if (n > in_.left())
      in_.fail("the file ends inside an array of " + std::to_string(n) + " values");
    if (binary_)
      in_.skip_bytes(n * size_of(type), "an array");
    else
      for (std::size_t i = 0; i < n; ++i) in_.word("a value");
  }

  // ---- sections
  void points() {
    if (has_points_) in_.fail("a second section POINTS");
    has_points_ = true;
    const std::size_t n = in_.count("the number of points", 3);
    const std::string type = type_word();
    if (type != "float" && type != "double")
      in_.fail("points of type '" + type + "', expected float or double");
    in_.check_fits(n, "the number of points", 3 * bytes_each(type) - 1);
    begin_values();
    mesh_.points.resize(n);
    for (Vec3& p : mesh_.points)
      for (int k = 0; k < 3; ++k) p[k] = real(type, "a coordinate");
  }

  void cells() {
    if (!has_points_) in_.fail("CELLS comes before POINTS");
    if (has_cells_) in_.fail("a second section CELLS");
    has_cells_ = true;
    cells_line_ = in_.line();
    const std::size_t first = in_.count("the number of cells", 1);
    const std::size_t size = in_.count("the size of the cell list", binary_ ? 4 : 1);
    if (version_ >= 5) return cells_by_offsets(first, size);
    begin_values();
    cells_.offsets.assign(1, 0);
    std::size_t used = 0;
    for (std::size_t c = 0; c < first; ++c) {
      const long long n = whole("int", "the number of points of a cell");
      if (n < 0 || static_cast<std::size_t>(n) + 1 > size - used)
        in_.fail("cell " + std::to_string(c) + " has " + std::to_string(n) +
                 " points, more than the size of the cell list leaves");
      used += static_cast<std::size_t>(n) + 1;
      for (long long k = 0; k < n; ++k)
        cells_.connectivity.push_back(whole("int", "a point of a cell"));
      cells_.offsets.push_back(static_cast<long long>(cells_.connectivity.size()));
    }
    if (used != size)
      in_.fail("the cell list holds " + std::to_string(used) + " numbers, expected " +
               std::to_string(size));
  }
  void cells_by_offsets(std::size_t offsets, std::size_t size) {
    in_.keyword("OFFSETS");
    std::string type = type_word();
    in_.check_fits(offsets, "the number of offsets", bytes_each(type) - (binary_ ? 0 : 1));
    begin_values();
    for (std::size_t i = 0; i < offsets; ++i) {
      const long long at = whole(type, "a cell offset");
      const long long before = i == 0 ? 0 : cells_.offsets.back();
      if (at < before || at > static_cast<long long>(size) || (i == 0 && at != 0))
        in_.fail("cell offset " + std::to_string(i) + " is " + std::to_string(at) +
                 ", expected ascending values from 0 to " + std::to_string(size));
      cells_.offsets.push_back(at);
    }
    in_.keyword("CONNECTIVITY");
    type = type_word();
    in_.check_fits(size, "the size of the cell list", bytes_each(type) - (binary_ ? 0 : 1));
    begin_values();
    for (std::size_t i = 0; i < size; ++i)
      cells_.connectivity.push_back(whole(type, "a point of a cell"));
    if (cells_.offsets.empty()) cells_.offsets.push_back(0);
  }
  std::size_t cell_count() const { return cells_.offsets.size() - 1; }

  void cell_types() {
    if (!has_cells_) in_.fail("CELL_TYPES comes before CELLS");
    const std::size_t n = in_.count("the number of cell types", 1);
    if (n != cell_count())
      in_.fail("there are " + std::to_string(n) + " cell types for " +
               std::to_string(cell_count()) + " cells");
    begin_values();
    cells_.types.clear();
    for (std::size_t c = 0; c < n; ++c) cells_.types.push_back(whole("int", "a cell type"));
  }

  void data(bool on_cells) {
    if (on_cells && !has_cells_) in_.fail("CELL_DATA comes before CELLS");
    on_cells_ = on_cells;
    data_count_ = in_.count(on_cells ? "the number of cell data" : "the number of point data", 0);
    if (on_cells && data_count_ != cell_count())
      in_.fail("CELL_DATA has " + std::to_string(data_count_) + " values for " +
               std::to_string(cell_count()) + " cells");
  }

  void metadata() {  // ends at an empty line
    in_.rest_of_line();
    while (in_.left() > 0 && !in_.rest_of_line().empty()) {
    }
  }

  void attribute(const std::string& key) {
    if (key == "FIELD") return field_data(on_cells_, data_count_);
    const std::string name(in_.word("the name of an attribute"));
    if (key == "LOOKUP_TABLE") {
      const std::size_t n = in_.count("the size of a lookup table", 4);
      begin_values();
      return skip_values(binary_ ? "unsigned_char" : "float", 4 * n);
    }
    std::size_t components = 0;
    std::string type;
    if (key == "COLOR_SCALARS") {
      components = in_.count("the number of components", 1);
      type = binary_ ? "unsigned_char" : "float";
    } else if (key == "TEXTURE_COORDINATES") {
      components = in_.count("the number of components", 1);
      type = type_word();
    } else {
      type = type_word();
      components = key == "SCALARS"                       ? 1
                   : key == "VECTORS" || key == "NORMALS" ? 3
                   : key == "TENSORS"                     ? 9
                                                          : 0;
    }
    if (components == 0 || components > 64)
      in_.fail("found '" + FileCursor::shortened(key) +
               "', expected a keyword of the VTK legacy format");
    if (key == "SCALARS") {
      const std::string_view rest = in_.rest_of_line();
      if (!rest.empty() && rest.find_first_of("234") != std::string_view::npos)
        components = static_cast<std::size_t>(rest[rest.find_first_of("234")] - '0');
      in_.keyword("LOOKUP_TABLE");
      in_.word("the name of a lookup table");
    }
    begin_values();
    array(name, type, components, data_count_, on_cells_);
  }

  void field_data(bool on_cells, std::size_t tuples) {
    in_.word("the name of a field");
    const std::size_t arrays = in_.count("the number of arrays of a field", 4);
    for (std::size_t a = 0; a < arrays; ++a) {
      const std::string name(in_.word("the name of an array"));
      if (name == "METADATA") {
        metadata();
        --a;
        continue;
      }
      const std::size_t components = in_.count("the number of components", 0);
      const std::size_t n = in_.count("the number of tuples", 0);
      const std::string type(in_.word("a data type"));
      if (size_of(type) == 0)
        in_.fail("data type '" + FileCursor::shortened(type) + "' of array '" +
                 FileCursor::shortened(name) + "' is not read");
      if (components > 64) in_.fail("an array of " + std::to_string(components) + " components");
      begin_values();
      array(name, type, components, n, on_cells && n == tuples);
    }
  }

  void array(const std::string& name, const std::string& type, std::size_t components,
             std::size_t tuples, bool on_cells) {
    const std::size_t rank = region_rank(name);
    if (!on_cells || components != 1 || rank >= region_rank_) {
      if (components != 0 && tuples > in_.left())
        in_.fail("an array of " + std::to_string(tuples) + " values does not fit in the file");
      return skip_values(type, components * tuples);
    }
    in_.check_fits(tuples, "the number of values", bytes_each(type) - (binary_ ? 0 : 1));
    region_rank_ = rank;
    cells_.region.clear();
    for (std::size_t i = 0; i < tuples; ++i) cells_.region.push_back(real(type, "a region tag"));
    if (cells_.region.size() != cell_count())
      in_.fail("array '" + name + "' has " + std::to_string(tuples) + " values for " +
               std::to_string(cell_count()) + " cells");
  }

  FileCursor& in_;
  MeshData mesh_;
  VtkCells cells_;
  int version_ = 0, cells_line_ = 0;
  bool binary_ = false, has_points_ = false, has_cells_ = false, on_cells_ = false;
  std::size_t data_count_ = 0;
  std::size_t region_rank_ = region_array_names.size();
};

}  // namespace

MeshData read_vtk_legacy(FileCursor& in) {
  return LegacyReader(in).read();
}

}  // namespace sutura::tissue
