#include "vtu.h"

#include <bit>
#include <cstring>

#include "sutura/units.h"

namespace sutura::output {
namespace {

static_assert(std::endian::native == std::endian::little, "byte_order in the files says so");

template <class T>
void append_bytes(std::vector<unsigned char>& bytes, const T* values, std::size_t count) {
  const std::size_t old = bytes.size();
  bytes.resize(old + count * sizeof(T));
  if (count > 0) std::memcpy(bytes.data() + old, values, count * sizeof(T));
}

class Writer {
 public:
  template <class T>
  void array(std::string_view type, std::string_view name, int components,
             const std::vector<T>& values, bool tuples_named = false) {
    text += "<DataArray type=\"" + std::string(type) + "\" Name=\"" + xml_escape(name) + "\"";
    if (components != 1) text += " NumberOfComponents=\"" + std::to_string(components) + "\"";
    if (tuples_named) text += " NumberOfTuples=\"" + std::to_string(values.size()) + "\"";
    text += " format=\"binary\">";
    const std::uint64_t size = values.size() * sizeof(T);
    std::vector<unsigned char> bytes;
    bytes.reserve(sizeof size + size);
    append_bytes(bytes, &size, 1);
    append_bytes(bytes, values.data(), values.size());
    text += base64(bytes) + "</DataArray>\n";
  }

  void fields(const VtuGrid& grid, bool on_cells) {
    const char* tag = on_cells ? "CellData" : "PointData";
    text += "<" + std::string(tag) + ">\n";
    for (const BodyGeometry::Field& f : grid.fields) {
      if (f.on_cells == on_cells) array("Float64", f.name, f.components, f.values);
    }
    text += "</" + std::string(tag) + ">\n";
  }

  std::string text;
};

}  // namespace

std::string base64(std::span<const unsigned char> bytes) {
  static constexpr char digits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < n ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) {
      out += k <= n ? digits[group >> (18 - 6 * k) & 63] : '=';
    }
  }
  return out;
}

std::string xml_escape(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&apos;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

int nodes_per_cell(VtkCell cell) {
  switch (cell) {
    case VtkCell::vertex:
      return 1;
    case VtkCell::line:
      return 2;
    case VtkCell::tetrahedron:
      return 4;
  }
  return 1;
}

std::string check(const VtuGrid& grid) {
  const auto nodes = static_cast<std::size_t>(nodes_per_cell(grid.cell));
  if (grid.connectivity.size() % nodes != 0) return "the connectivity ends within a cell";
  for (const Index i : grid.connectivity) {
    if (i < 0 || i >= static_cast<Index>(grid.points.size())) {
      return "a cell names point " + std::to_string(i) + " of " +
             std::to_string(grid.points.size());
    }
  }
  for (const BodyGeometry::Field& f : grid.fields) {
    const std::size_t places = f.on_cells ? grid.connectivity.size() / nodes : grid.points.size();
    if (f.values.size() != places * static_cast<std::size_t>(f.components)) {
      return "field '" + f.name + "' has " + std::to_string(f.values.size()) + " values for " +
             std::to_string(places) + (f.on_cells ? " cells" : " points");
    }
  }
  return {};
}

std::string vtu_text(const VtuGrid& grid, Real time) {
  const auto nodes = static_cast<std::int64_t>(nodes_per_cell(grid.cell));
  const std::size_t cells = grid.connectivity.size() / static_cast<std::size_t>(nodes);
  Writer w;
  w.text =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<UnstructuredGrid>\n<FieldData>\n";
  w.array("Float64", "TimeValue", 1, std::vector<Real>{time}, true);
  for (const auto& [name, value] : grid.constants) {
    w.array("Int32", name, 1, std::vector<std::int32_t>{value}, true);
  }
  w.text += "</FieldData>\n<Piece NumberOfPoints=\"" + std::to_string(grid.points.size()) +
            "\" NumberOfCells=\"" + std::to_string(cells) + "\">\n<Points>\n";
  std::vector<Real> coordinates;
  coordinates.reserve(3 * grid.points.size());
  for (const Vec3& p : grid.points) coordinates.insert(coordinates.end(), p.data(), p.data() + 3);
  w.array("Float64", "Points", 3, coordinates);
  w.text += "</Points>\n<Cells>\n";
  w.array("Int64", "connectivity", 1,
          std::vector<std::int64_t>(grid.connectivity.begin(), grid.connectivity.end()));
  std::vector<std::int64_t> offsets(cells);
  for (std::size_t i = 0; i < cells; ++i) offsets[i] = nodes * static_cast<std::int64_t>(i + 1);
  w.array("Int64", "offsets", 1, offsets);
  w.array("UInt8", "types", 1,
          std::vector<std::uint8_t>(cells, static_cast<std::uint8_t>(grid.cell)));
  w.text += "</Cells>\n";
  w.fields(grid, false);
  w.fields(grid, true);
  w.text += "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  return std::move(w.text);
}

namespace {
constexpr std::string_view pvd_end = "</Collection>\n</VTKFile>\n";
}

std::string PvdFile::open(const std::filesystem::path& file) {
  if (std::string error = file_.open(file); !error.empty()) return error;
  std::string error = file_.append(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n");
  return error.empty() ? file_.tail(pvd_end) : error;
}

std::string PvdFile::resume(const std::filesystem::path& file, std::int64_t end) {
  std::string error = file_.resume(file, end);
  return error.empty() ? file_.tail(pvd_end) : error;
}

std::string PvdFile::add(Real time, const std::filesystem::path& dataset) {
  std::string error =
      file_.append("<DataSet timestep=\"" + format_real(time) + "\" part=\"0\" file=\"" +
                   xml_escape(dataset.generic_string()) + "\"/>\n");
  return error.empty() ? file_.tail(pvd_end) : error;
}

}  // namespace sutura::output
