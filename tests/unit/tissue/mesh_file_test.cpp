// The readers: the same mesh out of every format, written by gmsh and VTK; and the faults they
// find.
#include "mesh_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "mesh_check.h"
#include "tissue_meshes.h"

namespace sutura::tissue {
namespace {

const std::filesystem::path folder = SUTURA_SOURCE_DIR "/tests/unit/tissue/meshes";

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class MeshFormats : public ::testing::TestWithParam<const char*> {};

TEST_P(MeshFormats, GivesTheMeshOfTheAsciiFile) {
  MeshReading expected = read_mesh(folder / "msh22_ascii.msh");
  MeshReading found = read_mesh(folder / GetParam());
  ASSERT_TRUE(expected.ok());
  ASSERT_TRUE(found.ok()) << found.problem->line << ": " << found.problem->message;
  ASSERT_EQ(found.mesh.points.size(), expected.mesh.points.size());
  for (std::size_t i = 0; i < found.mesh.points.size(); ++i)
    EXPECT_LT((found.mesh.points[i] - expected.mesh.points[i]).norm(),
              1e-11);  // VTK writes 12 digits of text
  EXPECT_EQ(found.mesh.tets, expected.mesh.tets);
  EXPECT_EQ(found.mesh.region, expected.mesh.region);
}

INSTANTIATE_TEST_SUITE_P(
    All, MeshFormats,
    ::testing::Values("msh22_binary.msh", "msh41_ascii.msh", "msh41_binary.msh", "gmsh_ascii.vtk",
                      "gmsh_binary.vtk", "vtk42_ascii.vtk", "vtk42_binary.vtk", "vtk51_ascii.vtk",
                      "vtk51_binary.vtk", "ascii.vtu", "base64.vtu", "base64_uint64_big.vtu",
                      "appended_raw.vtu", "appended_base64.vtu", "compressed.vtu",
                      "compressed_blocks_raw.vtu", "compressed_blocks_big.vtu", "meshio.vtu"),
    [](const auto& info) {
      std::string name = info.param;
      for (char& c : name)
        if (c == '.') c = '_';
      return name;
    });

TEST(MeshFile, ReadsTheTwoBoxes) {
  MeshReading reading = read_mesh(folder / "msh22_ascii.msh");
  ASSERT_TRUE(reading.ok());
  MeshData& mesh = reading.mesh;
  const CheckedMesh checked = check_mesh(mesh, false);
  EXPECT_EQ(checked.error, "");
  for (const std::string& warning : checked.report.warnings) ADD_FAILURE() << warning;
  EXPECT_EQ(mesh.region_names.at(7), "fat");
  EXPECT_EQ(mesh.region_names.at(12), "dermis");
  std::map<int, Real> volume;
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    const Tet& t = mesh.tets[e];
    volume[mesh.region[e]] +=
        six_volume(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]]) / 6;
  }
  EXPECT_NEAR(volume[7], 2, 1e-12);  // 2 x 1 x 1 each
  EXPECT_NEAR(volume[12], 2, 1e-12);
  Real area = 0;
  Vec3 closed = Vec3::Zero();
  for (const BoundaryFace& f : checked.boundary) {
    const Vec3 &a = mesh.points[f.nodes[0]], &b = mesh.points[f.nodes[1]],
               &c = mesh.points[f.nodes[2]];
    const Vec3 n = 0.5 * (b - a).cross(c - a);
    area += n.norm();
    closed += n;
    EXPECT_GT(n.dot((a + b + c) / 3 - Vec3(1, 0.5, 1)),
              0);  // a convex body: outward is away from its centre
  }
  EXPECT_NEAR(area, 2 * (2 * 1) + 2 * (2 * 2) + 2 * (1 * 2), 1e-12);
  EXPECT_LT(closed.norm(), 1e-12);
}

// Two cubes with a common side, which is one square of the first and four of the second. The five
// nodes of the second that are no corners of the square go their own way.
TEST(MeshCheck, FindsNodesThatHangWithinAFace) {
  MeshData mesh = test::kuhn_block({1, 1, 1}, Vec3::Ones());
  const MeshData other = test::kuhn_block({2, 2, 2}, Vec3::Ones());
  std::vector<Index> number;
  for (const Vec3& q : other.points) {
    const Vec3 p = q + Vec3::UnitX();
    const auto same = std::find(mesh.points.begin(), mesh.points.begin() + 8, p);
    number.push_back(static_cast<Index>(same - mesh.points.begin()));
    if (same != mesh.points.begin() + 8) continue;
    number.back() = static_cast<Index>(mesh.points.size());
    mesh.points.push_back(p);
  }
  for (Tet t : other.tets) {
    for (Index& i : t) i = number[static_cast<std::size_t>(i)];
    mesh.tets.push_back(t);
  }
  mesh.region.assign(mesh.tets.size(), 0);
  const CheckedMesh checked = check_mesh(mesh, false);
  EXPECT_EQ(checked.error, "");
  EXPECT_EQ(checked.report.hanging_nodes, 5);
  ASSERT_EQ(checked.report.warnings.size(), 1u);
  EXPECT_NE(checked.report.warnings.front().find("5 nodes lie within the face"), std::string::npos);
}

TEST(MeshFile, RefusesWhatItCannotRead) {
  EXPECT_EQ(read_mesh(folder / "nowhere.msh").problem->message, "no such file");
  EXPECT_EQ(read_mesh(folder).problem->message, "not a regular file");
}

// A compressed file with one byte of its text changed is read as it was or refused, never more.
TEST(MeshFile, DamagedCompressionIsSeen) {
  const std::string sound = bytes_of(folder / "compressed.vtu");
  const std::size_t expected = read_mesh_text(sound).mesh.points.size();
  int refused = 0;
  for (std::size_t i = 200; i < sound.size(); i += 7) {
    std::string bytes = sound;
    bytes[i] = bytes[i] == 'A' ? 'B' : 'A';
    const MeshReading reading = read_mesh_text(bytes);
    refused += reading.ok() ? 0 : 1;
    EXPECT_LE(reading.mesh.points.size(), expected) << i;
  }
  EXPECT_GT(refused, 100);
}

TEST(MeshFile, SaysWhereAMalformedFileIsWrong) {
  const std::filesystem::path bad = SUTURA_SOURCE_DIR "/tests/scenes/malformed_meshes";
  std::ifstream table(bad / "expected.tsv");
  std::string row;
  int cases = 0;
  while (std::getline(table, row)) {
    std::istringstream fields(row);
    std::string name, line, words;
    std::getline(fields, name, '\t');
    std::getline(fields, line, '\t');
    std::getline(fields, words, '\t');
    MeshReading reading = read_mesh(bad / name);
    std::string message;
    int at = 0;
    if (reading.problem) {
      message = reading.problem->message;
      at = reading.problem->line;
      EXPECT_TRUE(reading.mesh.tets.empty()) << name;
    } else {
      message = check_mesh(reading.mesh, false).error;
    }
    EXPECT_NE(message, "") << name;
    EXPECT_NE(message.find(words), std::string::npos)
        << name << ": '" << message << "', expected '" << words << "'";
    EXPECT_EQ(at, std::stoi(line)) << name << ": " << message;
    ++cases;
  }
  EXPECT_GE(cases, 30);
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(bad))
    if (entry.path().extension() != ".py" && entry.path().extension() != ".tsv") ++files;
  EXPECT_EQ(files, cases) << "a file without a line in expected.tsv";
}

/// Whether the mesh was read. What was read is a mesh that can be walked through, and what was
/// refused is empty and says why.
bool expect_sound_or_refused(MeshReading reading, const std::string& what) {
  const MeshData& mesh = reading.mesh;
  if (!reading.ok()) {
    EXPECT_NE(reading.problem->message, "") << what;
    EXPECT_TRUE(mesh.points.empty() && mesh.tets.empty() && mesh.region.empty()) << what;
    return false;
  }
  EXPECT_FALSE(mesh.tets.empty()) << what;
  EXPECT_EQ(mesh.region.size(), mesh.tets.size()) << what;
  for (const Vec3& p : mesh.points) EXPECT_TRUE(p.allFinite()) << what;
  for (const Tet& t : mesh.tets)
    for (const Index i : t)
      EXPECT_TRUE(i >= 0 && i < static_cast<Index>(mesh.points.size())) << what;
  const CheckedMesh checked = check_mesh(reading.mesh, true);
  if (checked.error.empty()) {
    for (const Tet& t : reading.mesh.tets) {
      const auto& p = reading.mesh.points;
      EXPECT_GT(six_volume(p[t[0]], p[t[1]], p[t[2]], p[t[3]]), 0) << what;
    }
  }
  return true;
}

// Every prefix of a good file, and the file with any byte changed, is read to the end or refused.
// Under the sanitizers this walks through every bound check.
TEST(MeshFile, SurvivesTruncationAndNoise) {
  for (const char* name :
       {"msh22_ascii.msh", "msh22_binary.msh", "msh41_ascii.msh", "msh41_binary.msh",
        "vtk42_ascii.vtk", "vtk42_binary.vtk", "vtk51_ascii.vtk", "vtk51_binary.vtk", "ascii.vtu",
        "base64.vtu", "appended_raw.vtu"}) {
    const std::string good = bytes_of(folder / name);
    std::uint32_t random = 1;
    for (std::size_t n = 0; n < good.size(); n += 1 + n / 40) {
      const std::string what = std::string(name) + " cut to " + std::to_string(n) + " bytes";
      const bool read =
          expect_sound_or_refused(read_mesh_text(std::string_view(good).substr(0, n)), what);
      // The regions stand at the end of some formats, but no tet in the first half of any.
      if (2 * n < good.size()) {
        EXPECT_FALSE(read) << what;
      }
    }
    int refused = 0;
    for (int i = 0; i < 300; ++i) {
      std::string noisy = good;
      for (int k = 0; k < 3; ++k) {
        random = random * 1664525u + 1013904223u;
        noisy[(random >> 8) % noisy.size()] = static_cast<char>(random >> 3);
      }
      const std::string what = std::string(name) + " with noise " + std::to_string(i);
      refused += !expect_sound_or_refused(read_mesh_text(noisy), what);
    }
    EXPECT_GT(refused, 0) << name;
  }
}

}  // namespace
}  // namespace sutura::tissue
