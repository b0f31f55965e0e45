#include "mesh_file.h"

#include <fstream>
#include <system_error>

#include "mesh_cursor.h"

namespace sutura::tissue {
namespace {

MeshData read_any(std::string_view bytes) {
  MeshCursor in(bytes);
  const std::string_view first = in.peek();
  if (first.empty()) in.fail("the file is empty");
  if (first == "$MeshFormat" || first == "$Comments") return read_gmsh(in);
  if (bytes.starts_with("# vtk DataFile")) return read_vtk_legacy(in);
  if (first.starts_with("<")) return read_vtu(bytes);
  in.fail("found '" + MeshCursor::shortened(first) +
          "', expected '$MeshFormat' (Gmsh), '# vtk DataFile' (VTK legacy) or '<VTKFile' (VTU)");
}

MeshReading failed(std::string message) {
  return {{}, MeshProblem{0, std::move(message)}};
}

}  // namespace

MeshReading read_mesh_text(std::string_view bytes) {
  try {
    MeshReading reading{read_any(bytes), {}};
    if (reading.mesh.tets.empty())
      return failed("the mesh has no tetrahedra (first-order, four nodes each)");
    return reading;
  } catch (const MeshProblem& problem) {
    return {{}, problem};
  }
}

MeshReading read_mesh(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return failed("no such file");
  if (!std::filesystem::is_regular_file(file, error)) return failed("not a regular file");
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) return failed("cannot be read: " + error.message());
  if (size > max_mesh_bytes)
    return failed("the file has " + std::to_string(size) + " bytes, more than the limit of " +
                  std::to_string(max_mesh_bytes));
  std::string bytes(static_cast<std::size_t>(size), '\0');
  std::ifstream in(file, std::ios::binary);
  if (!in.read(bytes.data(), static_cast<std::streamsize>(size))) return failed("cannot be read");
  return read_mesh_text(bytes);
}

}  // namespace sutura::tissue
