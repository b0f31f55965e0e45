#include "tet_mesh.h"

#include <set>

#include "mesh_file.h"
#include "sutura/units.h"

namespace sutura::tissue {
namespace {

Real metres(TetMesh::Unit unit) {
  return unit == TetMesh::Unit::mm ? 1e-3 : unit == TetMesh::Unit::cm ? 1e-2 : 1;
}

}  // namespace

void TetMesh::describe(Describe<TetMesh>& d) {
  d.summary(
      "A tetrahedral mesh read from a file: Gmsh MSH 2.2 or 4.1, VTK legacy or VTU, "
      "ASCII, binary or compressed by zlib. Physical groups (Gmsh) or the cell array 'region' "
      "(VTK) become regions. Faces, lines and points in it are left out; any other volume is an "
      "error.");
  d.attribute("file", &TetMesh::file, "The mesh file, relative to the scene.").required();
  d.attribute("unit", &TetMesh::unit, {"unstated", "m", "cm", "mm"},
              "The unit of length of the file; unstated means metres, with a warning if the mesh "
              "is so large that millimetres were probably meant.");
  d.output("nodes", "1", "Number of nodes.",
           [](const TetMesh& m) -> Real { return static_cast<Real>(m.data().points.size()); });
  d.output("tets", "1", "Number of tetrahedra.",
           [](const TetMesh& m) -> Real { return static_cast<Real>(m.data().tets.size()); });
}

void TetMesh::initialise(Setup& setup) {
  const std::filesystem::path path = setup.resolve(file.path);
  MeshReading reading = read_mesh(path);
  if (reading.problem) {
    // A fault inside the file is shown at its line there; one of the file as a whole, in the scene.
    const auto& [line, message] = *reading.problem;
    if (line > 0)
      setup.diagnostics.error({path.string(), line}, this->path(), message, Category::file);
    else
      setup.error(*this,
                  "mesh file '" + path.string() + "': " + message +
                      (std::filesystem::exists(path) ? "" : setup.did_you_mean_file(file.path)),
                  Category::file);
    return;
  }
  setup.note_if_outside(*this, file.path);
  for (Vec3& p : reading.mesh.points) p *= metres(unit);
  take(std::move(reading.mesh), "mesh file '" + file.path + "'", setup);
}

void TetMesh::take(MeshData data, const std::string& what, Setup& setup) {
  // Only a file can leave its unit open.
  shape_ = rest_shape(std::move(data), !file.path.empty() && unit == Unit::unstated,
                      setup.resources.cache.get());
  for (const std::string& warning : report().warnings)
    setup.warning(*this, what + ": " + warning, Category::file);
  if (const std::string& error = shape_->checked.error; !error.empty())
    setup.error(*this, what + ": " + error, Category::file);
}

std::optional<int> TetMesh::region(const std::string& name_or_tag, std::string& error) const {
  const std::set<int> present(data().region.begin(), data().region.end());
  std::string list;
  std::vector<std::string> names;
  std::vector<int> found;
  for (const int tag : present) {
    const auto named = data().region_names.find(tag);
    const std::string name = named == data().region_names.end() ? std::string() : named->second;
    if (name_or_tag == std::to_string(tag) || (!name.empty() && name_or_tag == name))
      found.push_back(tag);
    if (!name.empty()) names.push_back(name);
    list +=
        (list.empty() ? "" : ", ") + std::to_string(tag) + (name.empty() ? "" : " (" + name + ")");
  }
  if (found.size() == 1) return found.front();
  if (found.size() > 1) {
    error = "'" + name_or_tag + "' is the name or the number of " + std::to_string(found.size()) +
            " regions of the mesh; it has " + list;
    return {};
  }
  error = "the mesh has no region '" + name_or_tag + "'" + did_you_mean(name_or_tag, names) +
          "; it has " + list;
  return {};
}

}  // namespace sutura::tissue
