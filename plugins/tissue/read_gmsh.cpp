// Gmsh MSH 2.2 and 4.1, ASCII and binary. Layouts after the Gmsh reference manual, section "File
// formats".
#include <cstdint>
#include <map>
#include <set>
#include <unordered_map>
#include <vector>

#include "mesh_cursor.h"

namespace sutura::tissue {
namespace {

constexpr int type_tet = 4;
constexpr long long max_tag = std::numeric_limits<std::int32_t>::max();

/// Nodes per element of the types Gmsh writes for the usual orders; 0 if unknown.
int nodes_of_type(int type) {
  static const std::map<int, int> table{
      {1, 2},   {2, 3},   {3, 4},   {4, 4},   {5, 8},   {6, 6},   {7, 5},   {8, 3},   {9, 6},
      {10, 9},  {11, 10}, {12, 27}, {13, 18}, {14, 14}, {15, 1},  {16, 8},  {17, 20}, {18, 15},
      {19, 13}, {20, 9},  {21, 10}, {22, 12}, {23, 15}, {24, 15}, {25, 21}, {26, 4},  {27, 5},
      {28, 6},  {29, 20}, {30, 35}, {31, 56}, {92, 64}, {93, 125}};
  const auto it = table.find(type);
  return it == table.end() ? 0 : it->second;
}

bool is_volume(int type) {
  static const std::set<int> volumes{4, 5, 6, 7, 11, 12, 13, 14, 17, 18, 19, 29, 30, 31, 92, 93};
  return volumes.contains(type);
}

class GmshReader {
 public:
  explicit GmshReader(FileCursor& in) : in_(in) {}

  MeshData read() {
    while (!in_.peek().empty()) section();
    if (!has_nodes_) in_.fail("the file ends without a section '$Nodes'");
    if (!has_elements_) in_.fail("the file ends without a section '$Elements'");
    return std::move(mesh_);
  }

 private:
  void section() {
    const std::string name(in_.word("a section"));
    if (name.size() < 2 || name[0] != '$' || name.starts_with("$End"))
      in_.fail("found '" + FileCursor::shortened(name) +
               "', expected the start of a section ('$...')");
    if (name == "$MeshFormat")
      format();
    else if (name == "$Nodes" || name == "$Elements" || name == "$Entities") {
      if (version_ == 0) in_.fail("'" + name + "' comes before '$MeshFormat'");
      in_.rest_of_line();
      if (name == "$Entities")
        entities();
      else if (name == "$Nodes")
        version_ == 4 ? nodes4() : nodes2();
      else
        version_ == 4 ? elements4() : elements2();
    } else if (name == "$PhysicalNames")
      physical_names();
    else if (!in_.skip_past("$End" + name.substr(1)))
      in_.fail("section '" + FileCursor::shortened(name) + "' has no end");
    else
      return;
    in_.keyword("$End" + name.substr(1));
  }

  void format() {
    const std::string version(in_.word("the version of the format"));
    if (version == "2.2" || version == "2")
      version_ = 2;
    else if (version == "4.1")
      version_ = 4;
    else
      in_.fail("MSH version '" + FileCursor::shortened(version) +
               "' is not read; save the mesh as version 2.2 or 4.1");
    binary_ = in_.integer<int>("the file type (0 ASCII, 1 binary)", 0, 1) == 1;
    in_.integer<int>("the size of a floating-point number in bytes", 8, 8);
    in_.rest_of_line();
    if (!binary_) return;
    const auto one = in_.binary<std::int32_t>("the endianness mark");
    if (one == 0x01000000)
      in_.swap_bytes = true;
    else if (one != 1)
      in_.fail_binary("the endianness mark is neither 1 nor 1 with its bytes swapped");
  }

  void physical_names() {  // always text
    const std::size_t n = in_.count("the number of physical names", 6);
    for (std::size_t i = 0; i < n; ++i) {
      const int dimension = in_.integer<int>("the dimension of a physical group", 0, 3);
      const int tag = in_.integer<int>("the tag of a physical group", -max_tag, max_tag);
      std::string_view name = in_.rest_of_line();
      const std::size_t first = name.find('"'), last = name.rfind('"');
      if (first == std::string_view::npos || last == first)
        in_.fail("expected the name of a physical group in double quotes");
      if (dimension == 3)
        mesh_.region_names[tag] = std::string(name.substr(first + 1, last - first - 1));
    }
  }

  // One value of either form. `what` names it in messages.
  int tag(const char* what) {
    if (!binary_) return in_.integer<int>(what, -max_tag, max_tag);
    return in_.binary<std::int32_t>(what);
  }
  long long big(const char* what) {  // size_t of MSH 4.1
    if (!binary_) return in_.integer<long long>(what, 0, std::numeric_limits<long long>::max());
    const auto value = in_.binary<std::uint64_t>(what);
    if (value > std::uint64_t(std::numeric_limits<long long>::max()))
      in_.fail_binary(std::string(what) + " is too large");
    return static_cast<long long>(value);
  }
  /// `binary_bytes` and `text_bytes`: the least that one of the counted things takes.
  std::size_t big_count(const char* what, std::size_t binary_bytes, std::size_t text_bytes) {
    const long long n = big(what);
    in_.check_fits(static_cast<unsigned long long>(n), what, binary_ ? binary_bytes : text_bytes);
    return static_cast<std::size_t>(n);
  }
  Real coordinate() { return binary_ ? in_.binary_real("a coordinate") : in_.real("a coordinate"); }
  Vec3 point() {
    const Real x = coordinate(), y = coordinate(), z = coordinate();
    return {x, y, z};
  }

  void begin_nodes() {
    if (has_nodes_) in_.fail("a second section '$Nodes'");
    has_nodes_ = true;
  }
  void begin_elements() {
    if (!has_nodes_) in_.fail("'$Elements' comes before '$Nodes'");
    if (has_elements_) in_.fail("a second section '$Elements'");
    has_elements_ = true;
  }
  void add_node(long long node_tag, const Vec3& x) {
    if (!index_of_.emplace(node_tag, static_cast<Index>(mesh_.points.size())).second)
      in_.fail("node " + std::to_string(node_tag) + " is defined twice");
    mesh_.points.push_back(x);
  }
  void add_tet(const std::array<long long, 4>& tags, int region) {
    Tet tet;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto it = index_of_.find(tags[k]);
      if (it == index_of_.end())
        in_.fail("a tetrahedron uses node " + std::to_string(tags[k]) +
                 ", which is not in '$Nodes'");
      tet[k] = it->second;
    }
    mesh_.tets.push_back(tet);
    mesh_.region.push_back(region);
  }
  int checked_type(int type) {
    const int n = nodes_of_type(type);
    if (n == 0) in_.fail("element type " + std::to_string(type) + " is not known");
    if (type == 11 || type == 29 || type == 30 || type == 31)
      in_.fail("element type " + std::to_string(type) +
               " is a higher-order tetrahedron; save the mesh with order 1");
    // Left out, they would be holes in the tissue.
    if (type != type_tet && is_volume(type))
      in_.fail("element type " + std::to_string(type) +
               " is a hexahedron, prism or pyramid; expected tetrahedra only");
    return n;
  }

  void nodes2() {
    begin_nodes();
    const std::size_t n = in_.count("the number of nodes", binary_ ? 28 : 8);
    if (binary_) in_.rest_of_line();
    mesh_.points.reserve(n);
    index_of_.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
      const long long node = tag("a node number");
      add_node(node, point());
    }
  }

  void elements2() {
    begin_elements();
    const std::size_t n = in_.count("the number of elements", 4);
    if (binary_) in_.rest_of_line();
    mesh_.tets.reserve(n);
    mesh_.region.reserve(n);
    for (std::size_t done = 0; done < n;) {
      int type = 0, tags = 0;
      std::size_t in_block = 1;
      if (binary_) {
        type = in_.binary<std::int32_t>("an element type");
        const auto block = in_.binary<std::int32_t>("the number of elements of a block");
        tags = in_.binary<std::int32_t>("a number of tags");
        if (block < 1 || static_cast<std::size_t>(block) > n - done)
          in_.fail_binary("a block of " + std::to_string(block) + " elements, expected 1 to " +
                          std::to_string(n - done));
        in_block = static_cast<std::size_t>(block);
      } else {
        in_.integer<int>("an element number", -max_tag, max_tag);
        type = in_.integer<int>("an element type", -max_tag, max_tag);
        tags = in_.integer<int>("a number of tags", 0, 64);
      }
      if (tags < 0 || tags > 64) in_.fail_binary("a number of tags is " + std::to_string(tags));
      const int nodes = checked_type(type);
      for (std::size_t e = 0; e < in_block; ++e, ++done) {
        if (binary_) in_.binary<std::int32_t>("an element number");
        int region = 0;
        for (int t = 0; t < tags; ++t) {
          const int value = tag("an element tag");
          if (t == 0) region = value;  // the physical group comes first
        }
        element_nodes(type, nodes, region,
                      [&] { return static_cast<long long>(tag("a node number")); });
      }
    }
  }

  template <class NextNode>
  void element_nodes(int type, int nodes, int region, NextNode next) {
    std::array<long long, 4> corner{};
    for (int k = 0; k < nodes; ++k) {
      const long long node = next();
      if (k < 4) corner[static_cast<std::size_t>(k)] = node;
    }
    if (type == type_tet) add_tet(corner, region);
  }

  void entities() {
    std::array<std::size_t, 4> n{};
    for (auto& c : n) c = big_count("a number of entities", 12, 6);
    for (int dimension = 0; dimension < 4; ++dimension)
      for (std::size_t i = 0; i < n[static_cast<std::size_t>(dimension)]; ++i) {
        const int entity = tag("an entity tag");
        for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k) coordinate();
        const std::size_t physicals = big_count("a number of physical groups", 4, 2);
        for (std::size_t k = 0; k < physicals; ++k) {
          const int group = tag("a physical group");
          if (dimension == 3 && k == 0) region_of_volume_[entity] = group;
        }
        if (dimension == 0) continue;
        const std::size_t bounding = big_count("a number of bounding entities", 4, 2);
        for (std::size_t k = 0; k < bounding; ++k) tag("a bounding entity");
      }
  }

  void nodes4() {
    begin_nodes();
    const std::size_t blocks = big_count("the number of node blocks", 20, 8);
    const std::size_t n = big_count("the number of nodes", 32, 8);
    big("the smallest node number");
    big("the largest node number");
    mesh_.points.reserve(n);
    index_of_.reserve(n);
    std::vector<long long> numbers;
    for (std::size_t b = 0; b < blocks; ++b) {
      const int dimension = tag("the dimension of a node block");
      in_.check_range(dimension, "the dimension of a node block", 0, 3);
      tag("the entity of a node block");
      const bool parametric = tag("the mark of parametric nodes") != 0;
      const std::size_t in_block = big_count("the number of nodes of a block", 32, 8);
      if (in_block > n - mesh_.points.size())
        in_.fail("the node blocks hold more than the " + std::to_string(n) + " nodes announced");
      numbers.clear();
      for (std::size_t i = 0; i < in_block; ++i) numbers.push_back(big("a node number"));
      for (const long long number : numbers) {
        add_node(number, point());
        for (int k = 0; parametric && k < dimension; ++k) coordinate();
      }
    }
    if (mesh_.points.size() != n)
      in_.fail("the node blocks hold " + std::to_string(mesh_.points.size()) + " nodes, expected " +
               std::to_string(n));
  }

  void elements4() {
    begin_elements();
    const std::size_t blocks = big_count("the number of element blocks", 20, 8);
    const std::size_t n = big_count("the number of elements", 16, 4);
    big("the smallest element number");
    big("the largest element number");
    std::size_t done = 0;
    for (std::size_t b = 0; b < blocks; ++b) {
      const int dimension = tag("the dimension of an element block");
      in_.check_range(dimension, "the dimension of an element block", 0, 3);
      const int entity = tag("the entity of an element block");
      const int type = tag("an element type");
      const std::size_t in_block = big_count("the number of elements of a block", 16, 4);
      if (in_block > n - done)
        in_.fail("the element blocks hold more than the " + std::to_string(n) +
                 " elements announced");
      const int nodes = checked_type(type);
      const auto group = region_of_volume_.find(entity);
      const int region = dimension == 3 && group != region_of_volume_.end() ? group->second : 0;
      for (std::size_t e = 0; e < in_block; ++e, ++done) {
        big("an element number");
        element_nodes(type, nodes, region, [&] { return big("a node number"); });
      }
    }
    if (done != n)
      in_.fail("the element blocks hold " + std::to_string(done) + " elements, expected " +
               std::to_string(n));
  }

  FileCursor& in_;
  MeshData mesh_;
  int version_ = 0;
  bool binary_ = false, has_nodes_ = false, has_elements_ = false;
  std::unordered_map<long long, Index> index_of_;
  std::map<int, int> region_of_volume_;
};

}  // namespace

MeshData read_gmsh(FileCursor& in) {
  return GmshReader(in).read();
}

}  // namespace sutura::tissue
