#include "vtu.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <new>

#include "sutura/text.h"
#include "sutura/units.h"

namespace sutura::output {
namespace {

static_assert(std::endian::native == std::endian::little, "byte_order in the files says so");

using Bytes = std::vector<unsigned char>;

/// Packs as zlib does, without its search for what repeats: numbers of a simulation hardly do, and
/// a record is written in the middle of a run. It takes half the time and a tenth more room.
Bytes packed(const unsigned char* bytes, std::size_t size) {
  z_stream stream{};
  constexpr int fastest = 1, largest_window = 15, most_memory = 9;
  if (deflateInit2(&stream, fastest, Z_DEFLATED, largest_window, most_memory, Z_RLE) != Z_OK)
    throw std::bad_alloc();
  Bytes out(deflateBound(&stream, static_cast<uLong>(size)));
  stream.next_in = const_cast<unsigned char*>(bytes);  // zlib does not write there
  stream.avail_in = static_cast<uInt>(size);
  stream.next_out = out.data();
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);  // with the bound as its room it cannot fail
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

/// One block of zlib after the four numbers that VTK wants before it: how many blocks, their size,
/// that of the last if it is smaller, and the compressed size of each.
std::string compressed(const unsigned char* bytes, std::size_t size) {
  std::array<std::uint64_t, 4> header{1, size, 0, 0};
  if (size == 0) header[0] = 0;
  const Bytes block = size > 0 ? packed(bytes, size) : Bytes{};
  header[3] = block.size();
  const std::size_t numbers = size > 0 ? 4 : 3;
  Bytes head(numbers * sizeof header[0]);
  std::memcpy(head.data(), header.data(), head.size());
  return base64(head) + base64(block);
}

/// Seven digits are enough to look at a field and halve its file. Not for numbers out of the range
/// of single precision, and not for tags that it would round.
bool is_enough_in_single(const std::vector<Real>& values) {
  constexpr Real largest_whole = 1 << 24, largest = 3e38;
  return std::all_of(values.begin(), values.end(), [](Real x) {
    const Real size = std::abs(x);
    return !(size >= largest_whole) || (size < largest && x != std::floor(x)) || !std::isfinite(x);
  });
}

class Writer {
 public:
  template <class T>
  void array(std::string_view type, std::string_view name, int components,
             const std::vector<T>& values, bool tuples_named = false) {
    text += "<DataArray type=\"" + std::string(type) + "\" Name=\"" + xml_escaped(name) + "\"";
    if (components != 1) text += " NumberOfComponents=\"" + std::to_string(components) + "\"";
    if (tuples_named) text += " NumberOfTuples=\"" + std::to_string(values.size()) + "\"";
    text += " format=\"binary\">";
    text += compressed(reinterpret_cast<const unsigned char*>(values.data()),
                       values.size() * sizeof(T));
    text += "</DataArray>\n";
  }

  void fields(const VtuGrid& grid, bool on_cells) {
    const char* tag = on_cells ? "CellData" : "PointData";
    text += "<" + std::string(tag) + ">\n";
    for (const BodyGeometry::Field& f : grid.fields) {
      if (f.on_cells != on_cells) continue;
      if (is_enough_in_single(f.values))
        array("Float32", f.name, f.components,
              std::vector<float>(f.values.begin(), f.values.end()));
      else
        array("Float64", f.name, f.components, f.values);
    }
    text += "</" + std::string(tag) + ">\n";
  }

  std::string text;
};

}  // namespace

std::string base64(std::span<const unsigned char> bytes) {
  static constexpr char digits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out((bytes.size() + 2) / 3 * 4, '=');
  char* to = out.data();
  for (std::size_t i = 0; i < bytes.size(); i += 3, to += 4) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < n ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k <= n; ++k) to[k] = digits[group >> (18 - 6 * k) & 63];
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

namespace {

void pack(VtuCells& cells) {
  const int nodes = nodes_per_cell(cells.cell);
  const std::size_t number = cells.connectivity.size() / static_cast<std::size_t>(nodes);
  Writer w;
  w.text = "<Cells>\n";
  // 32 bits: more nodes than that are no scene of ours, and check() has looked at the indices.
  w.array("Int32", "connectivity", 1,
          std::vector<std::int32_t>(cells.connectivity.begin(), cells.connectivity.end()));
  std::vector<std::int32_t> offsets(number);
  for (std::size_t i = 0; i < number; ++i) offsets[i] = nodes * static_cast<std::int32_t>(i + 1);
  w.array("Int32", "offsets", 1, offsets);
  w.array("UInt8", "types", 1,
          std::vector<std::uint8_t>(number, static_cast<std::uint8_t>(cells.cell)));
  w.text += "</Cells>\n";
  cells.text = std::move(w.text);
}

}  // namespace

std::string vtu_text(const VtuGrid& grid, Real time, VtuCells& cells) {
  if (cells.text.empty() || cells.cell != grid.cell || cells.connectivity != grid.connectivity) {
    cells = {grid.cell, grid.connectivity, {}};
    pack(cells);
  }
  const auto nodes = static_cast<std::size_t>(nodes_per_cell(grid.cell));
  Writer w;
  w.text =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\" "
      "compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>\n<FieldData>\n";
  w.array("Float64", "TimeValue", 1, std::vector<Real>{time}, true);
  for (const auto& [name, value] : grid.constants) {
    w.array("Int32", name, 1, std::vector<std::int32_t>{value}, true);
  }
  w.text += "</FieldData>\n<Piece NumberOfPoints=\"" + std::to_string(grid.points.size()) +
            "\" NumberOfCells=\"" + std::to_string(grid.connectivity.size() / nodes) +
            "\">\n<Points>\n";
  std::vector<Real> coordinates;
  coordinates.reserve(3 * grid.points.size());
  for (const Vec3& p : grid.points) coordinates.insert(coordinates.end(), p.data(), p.data() + 3);
  w.array("Float64", "Points", 3, coordinates);
  w.text += "</Points>\n";
  w.text += cells.text;
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
                   xml_escaped(dataset.generic_string()) + "\"/>\n");
  return error.empty() ? file_.tail(pvd_end) : error;
}

}  // namespace sutura::output
