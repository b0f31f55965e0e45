#include "mesh_file.h"

#include <fstream>
#include <system_error>

#include "mesh_cursor.h"

namespace sutura::tissue {
namespace {

MeshData read_any(std::string_view bytes) {
  FileCursor in(bytes);
  const std::string_view first = in.peek();
  if (first.empty()) in.fail("the file is empty");
  if (first == "$MeshFormat" || first == "$Comments") return read_gmsh(in);
  if (bytes.starts_with("# vtk DataFile")) return read_vtk_legacy(in);
  if (first.starts_with("<")) return read_vtu(bytes);
  in.fail("found '" + FileCursor::shortened(first) +
          "', expected '$MeshFormat' (Gmsh), '# vtk DataFile' (VTK legacy) or '<VTKFile' (VTU)");
}

MeshReading failed(std::string message) {
  return {{}, FileProblem{0, std::move(message)}};
}

}  // namespace

MeshReading read_mesh_text(std::string_view bytes) {
  try {
    MeshReading reading{read_any(bytes), {}};
    if (reading.mesh.tets.empty())
      return failed("the mesh has no tetrahedra (first-order, four nodes each)");
    return reading;
  } catch (const FileProblem& problem) {
    return {{}, problem};
  }
}

MeshReading read_mesh(const std::filesystem::path& file) {
  try {
    return read_mesh_text(read_bytes(file, max_mesh_bytes));
  } catch (const FileProblem& problem) {
    return {{}, problem};
  }
}

}  // namespace sutura::tissue
