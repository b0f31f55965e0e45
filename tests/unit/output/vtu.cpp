// The .vtu and .pvd texts, read back by a reader of our own and by VTK.
#include "vtu.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>

#include "unit/output/vtu_reader.h"

namespace sutura::output {
namespace {

std::string encode(std::string_view text) {
  return base64({reinterpret_cast<const unsigned char*>(text.data()), text.size()});
}

TEST(Base64, VectorsOfRfc4648) {
  EXPECT_EQ(encode(""), "");
  EXPECT_EQ(encode("f"), "Zg==");
  EXPECT_EQ(encode("fo"), "Zm8=");
  EXPECT_EQ(encode("foo"), "Zm9v");
  EXPECT_EQ(encode("foob"), "Zm9vYg==");
  EXPECT_EQ(encode("fooba"), "Zm9vYmE=");
  EXPECT_EQ(encode("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encode("\xff\xfe\xfd"), "//79");  // digits 62 and 63
}

/// Two tetrahedra with a value per point and a vector per cell.
VtuGrid two_tetrahedra() {
  VtuGrid g;
  g.cell = VtkCell::tetrahedron;
  g.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1e-17}};
  g.connectivity = {0, 1, 2, 3, 1, 2, 3, 4};
  g.fields = {{"height [m]", false, 1, {0, 0, 0, 1, 0.1}},
              {"flux <a&b>", true, 3, {1, 2, 3, -4, 5.5, 1e300}}};
  g.constants = {{"law 0 is path", 0}};
  return g;
}

VtuGrid line() {
  VtuGrid g;
  g.cell = VtkCell::line;
  for (int i = 0; i < 4; ++i) g.points.emplace_back(i * 1e-3, 0, 0);
  g.connectivity = {0, 1, 1, 2, 2, 3};
  g.fields = {{"radius [m]", false, 1, {1e-4, 1e-4, 2e-4, 2e-4}}};
  return g;
}

std::string text_of(const VtuGrid& grid, Real time) {
  VtuCells cells;
  return vtu_text(grid, time, cells);
}

// Of a series, cells are packed once; other cells, or the same as another kind, are packed anew.
TEST(Vtu, TellsOtherCellsFromTheLast) {
  VtuGrid g = line();
  VtuCells cells;
  for (const std::vector<Index>& connectivity :
       {g.connectivity, g.connectivity, {0, 2, 1, 3}, {0, 3}}) {
    g.connectivity = connectivity;
    EXPECT_EQ(vtu_text(g, 0, cells), text_of(g, 0));
  }
  g.cell = VtkCell::vertex;
  g.fields.clear();
  EXPECT_EQ(vtu_text(g, 0, cells), text_of(g, 0));
}

TEST(Vtu, NumbersComeBackBitForBit) {
  const VtuGrid g = two_tetrahedra();
  const auto arrays = read_vtu_arrays(text_of(g, 0.1));
  const auto points = arrays.at("Points").numbers<double>();
  ASSERT_EQ(points.size(), 15u);
  for (std::size_t i = 0; i < 15; ++i) {
    EXPECT_EQ(points[i], g.points[i / 3][static_cast<Index>(i % 3)]);
  }
  const auto heights = arrays.at("height [m]").numbers<float>();
  ASSERT_EQ(heights.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_EQ(heights[i], static_cast<float>(g.fields[0].values[i]));
  // 1e300 is too large for single precision, so the field keeps what it has.
  EXPECT_EQ(arrays.at("flux &lt;a&amp;b&gt;").numbers<double>(), g.fields[1].values);
  EXPECT_EQ(arrays.at("connectivity").numbers<std::int32_t>(),
            (std::vector<std::int32_t>{0, 1, 2, 3, 1, 2, 3, 4}));
  EXPECT_EQ(arrays.at("offsets").numbers<std::int32_t>(), (std::vector<std::int32_t>{4, 8}));
  EXPECT_EQ(arrays.at("types").numbers<std::uint8_t>(), (std::vector<std::uint8_t>{10, 10}));
  EXPECT_EQ(arrays.at("TimeValue").numbers<double>(), std::vector<double>{0.1});
  EXPECT_EQ(arrays.at("law 0 is path").numbers<std::int32_t>(), std::vector<std::int32_t>{0});
}

TEST(Vtu, TagsAreNotRounded) {
  VtuGrid g = two_tetrahedra();
  g.fields = {{"region", true, 1, {16777217, 3}}};  // 2^24 + 1
  EXPECT_EQ(read_vtu_arrays(text_of(g, 0)).at("region").numbers<double>(),
            (std::vector<double>{16777217, 3}));
}

TEST(Vtu, IsASmallPartOfTheBareNumbers) {
  VtuGrid g;  // a regular grid, which compresses well: half of the bare bytes, base64 included
  g.cell = VtkCell::line;
  for (int i = 0; i < 1000; ++i) g.points.emplace_back(i % 10, i / 10 % 10, i / 100);
  for (Index i = 0; i + 1 < 1000; ++i) g.connectivity.insert(g.connectivity.end(), {i, i + 1});
  g.fields = {{"held", false, 1, std::vector<Real>(1000, 0)}};
  const std::size_t bare = 1000 * 3 * 8 + 999 * 2 * 4 + 999 * 4 + 999 + 1000 * 4;
  EXPECT_LT(text_of(g, 0).size(), bare / 2);
}

TEST(Vtu, CheckRefusesWhatCannotBeRead) {
  EXPECT_EQ(check(two_tetrahedra()), "");
  EXPECT_EQ(check(VtuGrid{}), "");
  VtuGrid g = two_tetrahedra();
  g.connectivity.pop_back();
  EXPECT_NE(check(g).find("within a cell"), std::string::npos);
  g = two_tetrahedra();
  g.connectivity[3] = 5;
  EXPECT_NE(check(g).find("point 5 of 5"), std::string::npos);
  g = two_tetrahedra();
  g.connectivity[3] = -1;
  EXPECT_NE(check(g), "");
  g = two_tetrahedra();
  g.fields[0].values.pop_back();
  EXPECT_NE(check(g).find("height"), std::string::npos);
  g = two_tetrahedra();
  g.fields[1].on_cells = false;
  EXPECT_NE(check(g).find("flux"), std::string::npos);
}

std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

TEST(Pvd, IsCompleteAfterEveryAdd) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "sutura_pvd/a.pvd";
  const std::string end = "</Collection>\n</VTKFile>\n";
  PvdFile pvd;
  ASSERT_EQ(pvd.open(file), "");
  EXPECT_TRUE(contents(file).ends_with(end));
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(pvd.add(0.01 * i, "a/a_" + std::to_string(i) + ".vtu"), "");
    const std::string text = contents(file);
    EXPECT_TRUE(text.ends_with("file=\"a/a_" + std::to_string(i) + ".vtu\"/>\n" + end)) << text;
    EXPECT_EQ(text.find("</Collection>"), text.size() - end.size()) << "closed once";
  }
  EXPECT_EQ(pvd.close(), "");
  EXPECT_NE(contents(file).find("timestep=\"0.02\""), std::string::npos);
}

TEST(OutputFile, FailuresNameTheFile) {
  OutputFile out;
  const std::filesystem::path folder = testing::TempDir();
  EXPECT_NE(out.open(folder).find(folder.string()), std::string::npos);  // a folder, not a file
  EXPECT_NE(out.append("x"), "");
  const auto file = folder / "sutura_plain_file";
  ASSERT_EQ(write_file(file, "x"), "");
  EXPECT_NE(out.open(file / "below").find("below"), std::string::npos);
}

// VTK is the judge of its own format. The script prints what VTK read.
TEST(Vtu, VtkReadsIt) {
  const std::string python = "/usr/bin/python3";
  ASSERT_EQ(std::system((python + " -c 'import vtkmodules.vtkIOXML' 2>/dev/null").c_str()), 0)
      << "VTK for Python (Debian: python3-vtk9) is missing; ./dev test installs it";
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "sutura_vtu";
  ASSERT_EQ(write_file(folder / "tets.vtu", text_of(two_tetrahedra(), 0.25)), "");
  ASSERT_EQ(write_file(folder / "line.vtu", text_of(line(), 0)), "");
  ASSERT_EQ(write_file(folder / "empty.vtu", text_of(VtuGrid{}, 0)), "");
  const std::string script = std::string(SUTURA_SOURCE_DIR) + "/tests/unit/output/print_vtu.py";
  const auto out = folder / "printed.txt";
  const std::string command = python + " '" + script + "' '" + (folder / "tets.vtu").string() +
                              "' '" + (folder / "line.vtu").string() + "' '" +
                              (folder / "empty.vtu").string() + "' > '" + out.string() + "' 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0) << contents(out);
  EXPECT_EQ(contents(out),
            "tets.vtu points 5 cells 2 types 10 time 0.25\n"
            "  point height [m]: 0.0 0.0 0.0 1.0 0.10000000149011612\n"
            "  cell flux <a&b>: 1.0 2.0 3.0 -4.0 5.5 1e+300\n"
            "  field law 0 is path: 0.0\n"
            "line.vtu points 4 cells 3 types 3 time 0.0\n"
            "  point radius [m]: 9.999999747378752e-05 9.999999747378752e-05 "
            "0.00019999999494757503 0.00019999999494757503\n"
            "empty.vtu points 0 cells 0 types  time 0.0\n");
}

}  // namespace
}  // namespace sutura::output
