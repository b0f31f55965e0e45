// VTU files: ASCII, inline base64 and appended (base64 or raw) arrays, plain or
// compressed by zlib.
// TinyXML2 gives the tree; every number is read by our own code.
#include <tinyxml2.h>
#include <zlib.h>

#include <bit>
#include <optional>

#include "read_vtk.h"

namespace sutura::tissue {
namespace {

using tinyxml2::XMLElement;

[[noreturn]] void fail(const XMLElement* at, const std::string& message) {
  throw FileProblem{at ? at->GetLineNum() : 0, message};
}

int base64_value(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

/// Decodes until `limit` bytes are there or the text ends. VTK may close the header with padding
/// and start anew, so padding inside the text is no fault.
std::optional<std::string> decode_base64(std::string_view text, std::size_t limit) {
  std::string out;
  out.reserve(std::min(limit, text.size()));
  unsigned buffer = 0;
  int digits = 0;
  for (const char c : text) {
    if (out.size() >= limit) break;
    if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
    if (c == '=') {
      if (digits == 2)
        out += static_cast<char>(buffer >> 4);
      else if (digits == 3)
        out += static_cast<char>(buffer >> 10), out += static_cast<char>(buffer >> 2);
      digits = 0, buffer = 0;
      continue;
    }
    const int value = base64_value(c);
    if (value < 0) return {};
    buffer = (buffer << 6) | static_cast<unsigned>(value);
    if (++digits < 4) continue;
    for (const int shift : {16, 8, 0}) out += static_cast<char>(buffer >> shift);
    digits = 0, buffer = 0;
  }
  return out;
}

class VtuReader {
 public:
  explicit VtuReader(std::string_view bytes) {
    // Raw appended data is not XML: cut it out before parsing.
    const std::size_t tag = bytes.find("<AppendedData");
    if (tag == std::string_view::npos) {
      parse(std::string(bytes));
      return;
    }
    const std::size_t open = bytes.find('>', tag);
    const std::size_t mark = open == std::string_view::npos ? open : bytes.find('_', open);
    if (mark == std::string_view::npos) throw FileProblem{0, "<AppendedData> without its '_' mark"};
    appended_ = bytes.substr(mark + 1);
    appended_raw_ = bytes.substr(tag, open - tag).find("\"raw\"") != std::string_view::npos;
    parse(std::string(bytes.substr(0, tag)) + "</VTKFile>");
  }

  MeshData read() {
    const XMLElement* file = document_.RootElement();
    if (!file || std::string_view(file->Name()) != "VTKFile")
      fail(file, "expected the element <VTKFile>");
    if (text(file, "type") != "UnstructuredGrid")
      fail(file, "the file holds '" + FileCursor::shortened(text(file, "type")) +
                     "', expected type=\"UnstructuredGrid\"");
    const std::string_view compressor = text(file, "compressor");
    compressed_ = !compressor.empty();
    if (compressed_ && compressor != "vtkZLibDataCompressor")
      fail(file, "compressor=\"" + FileCursor::shortened(compressor) +
                     "\"; expected vtkZLibDataCompressor, or none");
    swap_ = (text(file, "byte_order") == "BigEndian") != (std::endian::native == std::endian::big);
    header_bytes_ = text(file, "header_type") == "UInt64" ? 8 : 4;

    const XMLElement* piece = child(child(file, "UnstructuredGrid"), "Piece");
    if (piece->NextSiblingElement("Piece"))
      fail(piece->NextSiblingElement("Piece"),
           "more than one <Piece>; merge the pieces into one file");
    const std::size_t points = count(piece, "NumberOfPoints");
    const std::size_t cells = count(piece, "NumberOfCells");

    MeshData mesh;
    read_points(child(child(piece, "Points"), "DataArray"), points, mesh);
    VtkCells list;
    const XMLElement* cells_element = child(piece, "Cells");
    read_cells(cells_element, cells, list);
    read_region(piece->FirstChildElement("CellData"), cells, list);
    take_tets(list, cells_element->GetLineNum(), mesh);
    return mesh;
  }

 private:
  void parse(const std::string& xml) {
    if (document_.Parse(xml.data(), xml.size()) != tinyxml2::XML_SUCCESS)
      throw FileProblem{document_.ErrorLineNum(),
                        std::string("not well-formed XML (") + document_.ErrorName() + ")"};
  }
  static std::string_view text(const XMLElement* e, const char* attribute) {
    const char* value = e->Attribute(attribute);
    return value ? std::string_view(value) : std::string_view();
  }
  static const XMLElement* child(const XMLElement* parent, const char* name) {
    const XMLElement* e = parent->FirstChildElement(name);
    if (!e) fail(parent, std::string("<") + parent->Name() + "> has no element <" + name + ">");
    return e;
  }
  static std::size_t whole(const XMLElement* e, const char* attribute) {
    const std::string_view t = text(e, attribute);
    std::uint64_t n = 0;
    const auto [end, error] = std::from_chars(t.data(), t.data() + t.size(), n);
    if (error != std::errc{} || end != t.data() + t.size())
      fail(e, std::string(attribute) + "=\"" + FileCursor::shortened(t) + "\", expected a count");
    return n;
  }
  static std::size_t count(const XMLElement* e, const char* attribute) {
    const std::size_t n = whole(e, attribute);
    if (n > max_mesh_bytes)
      fail(e, std::string(attribute) + " is " + std::to_string(n) +
                  ", more than any mesh file can hold");
    return n;
  }
  static std::size_t type_bytes(std::string_view type) {
    if (type == "Float64" || type == "Int64" || type == "UInt64") return 8;
    if (type == "Float32" || type == "Int32" || type == "UInt32") return 4;
    if (type == "Int16" || type == "UInt16") return 2;
    return type == "Int8" || type == "UInt8" ? 1 : 0;
  }

  /// All values of an array, `n` expected, as T (double or long long).
  template <class T>
  std::vector<T> values(const XMLElement* array, std::size_t n) {
    const std::string_view type = text(array, "type"), format = text(array, "format");
    const std::size_t each = type_bytes(type);
    if (each == 0)
      fail(array, "type=\"" + FileCursor::shortened(type) +
                      "\", expected Int8 to UInt64 or Float32, Float64");
    if constexpr (std::is_integral_v<T>)
      if (type.starts_with("Float"))
        fail(array, "an array of Float numbers where whole numbers were expected");
    if (format == "ascii") return ascii_values<T>(array, n);
    std::string data;
    if (format == "binary") {
      data = inline_block(array, array->GetText() ? array->GetText() : "", n * each, false);
    } else if (format == "appended") {
      const std::size_t offset = whole(array, "offset");
      if (offset > appended_.size())
        fail(array, "offset " + std::to_string(offset) + " lies behind the end of <AppendedData>");
      data = inline_block(array, appended_.substr(offset), n * each, appended_raw_);
    } else {
      fail(array,
           "format=\"" + FileCursor::shortened(format) + "\", expected ascii, binary or appended");
    }
    FileCursor in(data);
    in.swap_bytes = swap_;
    std::vector<T> out;
    out.reserve(n);
    for (std::size_t i = 0; i < n; ++i) out.push_back(value<T>(in, type, array));
    return out;
  }

  template <class T>
  T value(FileCursor& in, std::string_view type, const XMLElement* array) {
    double real = 0;
    if (type == "Float64")
      real = in.binary<double>("a value");
    else if (type == "Float32")
      real = in.binary<float>("a value");
    else if (type == "Int64")
      return static_cast<T>(in.binary<std::int64_t>("a value"));
    else if (type == "UInt64")
      return static_cast<T>(in.binary<std::uint64_t>("a value"));
    else if (type == "Int32")
      return static_cast<T>(in.binary<std::int32_t>("a value"));
    else if (type == "UInt32")
      return static_cast<T>(in.binary<std::uint32_t>("a value"));
    else if (type == "Int16")
      return static_cast<T>(in.binary<std::int16_t>("a value"));
    else if (type == "UInt16")
      return static_cast<T>(in.binary<std::uint16_t>("a value"));
    else if (type == "Int8")
      return static_cast<T>(in.binary<std::int8_t>("a value"));
    else
      return static_cast<T>(in.binary<std::uint8_t>("a value"));
    if (!std::isfinite(real)) fail(array, "the array holds a number that is not finite");
    return static_cast<T>(real);
  }

  template <class T>
  std::vector<T> ascii_values(const XMLElement* array, std::size_t n) {
    const std::string_view content = array->GetText() ? array->GetText() : "";
    if (n > content.size()) wrong_length(array, n);
    FileCursor in(content);
    std::vector<T> out;
    out.reserve(n);
    try {
      while (!in.peek().empty() && out.size() < n) {
        if constexpr (std::is_integral_v<T>)
          out.push_back(in.integer<T>("a value", std::numeric_limits<T>::min(),
                                      std::numeric_limits<T>::max()));
        else
          out.push_back(in.real("a value"));
      }
    } catch (const FileProblem& p) {
      throw FileProblem{array->GetLineNum() + p.line - 1, p.message};
    }
    if (out.size() != n || !in.peek().empty()) wrong_length(array, n);
    return out;
  }
  [[noreturn]] static void wrong_length(const XMLElement* array, std::size_t n) {
    fail(array, "the array '" + FileCursor::shortened(text(array, "Name")) +
                    "' does not hold the " + std::to_string(n) + " values expected");
  }

  /// The bytes of an array without what stands in front of them.
  std::string inline_block(const XMLElement* array, std::string_view source, std::size_t expected,
                           bool raw) {
    if (compressed_) return compressed_block(array, source, expected, raw);
    if (expected > source.size()) wrong_block(array, source.size(), expected);
    const std::string data = bytes(array, source, header_bytes_ + expected, raw);
    if (data.size() < header_bytes_) wrong_block(array, data.size(), expected);
    FileCursor in(data);
    in.swap_bytes = swap_;
    const std::uint64_t stated = size_from(in);
    if (stated != expected) wrong_block(array, stated, expected);
    if (data.size() - header_bytes_ < expected)
      wrong_block(array, data.size() - header_bytes_, expected);
    return data.substr(header_bytes_, expected);
  }

  /// Up to `limit` bytes of an array, decoded.
  static std::string bytes(const XMLElement* array, std::string_view source, std::size_t limit,
                           bool raw) {
    if (raw) return std::string(source.substr(0, limit));
    auto decoded = decode_base64(source, limit);
    if (!decoded) fail(array, "the array holds a character that is not base64");
    decoded->resize(std::min(decoded->size(), limit));
    return std::move(*decoded);
  }
  std::uint64_t size_from(FileCursor& in) const {
    return header_bytes_ == 8 ? in.binary<std::uint64_t>("a block size")
                              : in.binary<std::uint32_t>("a block size");
  }

  /// In front: the number of blocks, the size of a block, of the last (0: it is whole), then the
  /// compressed size of each. In base64 this header is encoded apart from the blocks.
  std::string compressed_block(const XMLElement* array, std::string_view source,
                               std::size_t expected, bool raw) {
    // zlib shrinks by a factor of 1032 at most: a file cannot ask for more than it can hold.
    if (expected / 1032 > source.size()) wrong_block(array, source.size(), expected);
    const std::string first = bytes(array, source, header_bytes_, raw);
    if (first.size() < header_bytes_) wrong_block(array, first.size(), expected);
    FileCursor count(first);
    count.swap_bytes = swap_;
    const std::uint64_t blocks = size_from(count);
    if (blocks > source.size() / header_bytes_)
      fail(array, std::to_string(blocks) + " compressed blocks, more than the file can hold");
    const std::size_t header_size = header_bytes_ * (3 + static_cast<std::size_t>(blocks));
    const std::string header = bytes(array, source, header_size, raw);
    if (header.size() < header_size) wrong_block(array, header.size(), expected);
    FileCursor in(header);
    in.swap_bytes = swap_;
    size_from(in);
    const std::uint64_t whole_size = size_from(in), last_size = size_from(in);
    std::vector<std::size_t> sizes;
    std::size_t packed_size = 0;
    for (std::uint64_t i = 0; i < blocks; ++i) {
      const std::uint64_t size = size_from(in);
      if (size > source.size() - std::min(source.size(), packed_size))
        fail(array,
             "a compressed block of " + std::to_string(size) + " bytes, more than the file holds");
      sizes.push_back(static_cast<std::size_t>(size));
      packed_size += sizes.back();
    }
    const std::size_t digits = raw ? header_size : (header_size + 2) / 3 * 4;
    const std::string_view rest = source.substr(after_digits(source, digits, raw));
    return inflate(array, bytes(array, rest, packed_size, raw), sizes, whole_size, last_size,
                   expected);
  }

  /// Where the text goes on after so many base64 digits; blanks between them do not count.
  static std::size_t after_digits(std::string_view text, std::size_t digits, bool raw) {
    std::size_t i = 0;
    for (; i < text.size() && digits > 0; ++i)
      if (raw || (text[i] != ' ' && text[i] != '\n' && text[i] != '\r' && text[i] != '\t'))
        --digits;
    return i;
  }

  static std::string inflate(const XMLElement* array, const std::string& packed,
                             const std::vector<std::size_t>& sizes, std::uint64_t whole_size,
                             std::uint64_t last_size, std::size_t expected) {
    std::string out;
    out.reserve(expected);
    std::size_t at = 0;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      const bool is_last = i + 1 == sizes.size() && last_size > 0;
      const std::uint64_t size = is_last ? last_size : whole_size;
      if (size > expected - out.size()) wrong_block(array, out.size() + size, expected);
      if (at + sizes[i] > packed.size()) wrong_block(array, packed.size(), at + sizes[i]);
      const std::size_t old = out.size();
      out.resize(old + static_cast<std::size_t>(size));
      uLongf length = static_cast<uLongf>(size);
      const int code = uncompress(reinterpret_cast<Bytef*>(out.data() + old), &length,
                                  reinterpret_cast<const Bytef*>(packed.data() + at),
                                  static_cast<uLong>(sizes[i]));
      if (code != Z_OK || length != size)
        fail(array, "block " + std::to_string(i + 1) + " of the array '" +
                        FileCursor::shortened(text(array, "Name")) + "' is not what zlib wrote");
      at += sizes[i];
    }
    if (out.size() != expected) wrong_block(array, out.size(), expected);
    return out;
  }

  [[noreturn]] static void wrong_block(const XMLElement* array, std::size_t found,
                                       std::size_t expected) {
    fail(array, "the block of array '" + FileCursor::shortened(text(array, "Name")) + "' has " +
                    std::to_string(found) + " bytes, expected " + std::to_string(expected) +
                    " (is header_type or byte_order wrong?)");
  }

  void read_points(const XMLElement* array, std::size_t n, MeshData& mesh) {
    if (text(array, "NumberOfComponents") != "3")
      fail(array, "points need NumberOfComponents=\"3\"");
    const std::vector<double> x = values<double>(array, 3 * n);
    mesh.points.resize(n);
    for (std::size_t i = 0; i < n; ++i) mesh.points[i] = {x[3 * i], x[3 * i + 1], x[3 * i + 2]};
  }

  static const XMLElement* named_array(const XMLElement* parent, std::string_view name) {
    for (const XMLElement* a = parent->FirstChildElement("DataArray"); a;
         a = a->NextSiblingElement("DataArray"))
      if (text(a, "Name") == name) return a;
    return nullptr;
  }

  void read_cells(const XMLElement* element, std::size_t n, VtkCells& list) {
    const XMLElement *offsets = named_array(element, "offsets"),
                     *types = named_array(element, "types"),
                     *connectivity = named_array(element, "connectivity");
    if (!offsets || !types || !connectivity)
      fail(element, "<Cells> needs the arrays connectivity, offsets and types");
    list.types = values<long long>(types, n);
    list.offsets = values<long long>(offsets, n);
    list.offsets.insert(list.offsets.begin(), 0);
    for (std::size_t c = 0; c < n; ++c)
      if (list.offsets[c + 1] < list.offsets[c]) fail(offsets, "the offsets do not ascend");
    if (list.offsets.back() > static_cast<long long>(max_mesh_bytes))
      fail(offsets, "the last offset is too large");
    list.connectivity =
        values<long long>(connectivity, static_cast<std::size_t>(list.offsets.back()));
  }

  void read_region(const XMLElement* data, std::size_t n, VtkCells& list) {
    if (!data) return;
    for (const std::string_view name : region_array_names)
      if (const XMLElement* array = named_array(data, name)) {
        list.region = values<double>(array, n);
        return;
      }
  }

  tinyxml2::XMLDocument document_;
  std::string_view appended_;
  bool appended_raw_ = false, swap_ = false, compressed_ = false;
  std::size_t header_bytes_ = 4;
};

}  // namespace

MeshData read_vtu(std::string_view bytes) {
  return VtuReader(bytes).read();
}

}  // namespace sutura::tissue
