// Any bytes are a mesh or are refused with a reason. The corpora gmsh, vtk and vtu begin as their
// formats do, and the reader goes by that.
#include <cstdio>
#include <cstdlib>

#include "mesh_check.h"
#include "mesh_file.h"

using namespace sutura;
using namespace sutura::tissue;

namespace {

[[noreturn]] void fail(const char* what) {
  std::fprintf(stderr, "%s\n", what);
  std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  MeshReading reading = read_mesh_text({reinterpret_cast<const char*>(data), size});
  if (!reading.ok()) {
    if (reading.problem->message.empty()) fail("an empty message");
    return 0;
  }
  MeshData& mesh = reading.mesh;
  if (mesh.tets.empty() || mesh.region.size() != mesh.tets.size()) fail("no mesh");
  for (const Tet& t : mesh.tets)
    for (const Index i : t)
      if (i < 0 || i >= static_cast<Index>(mesh.points.size())) fail("an index out of range");
  for (const Vec3& p : mesh.points)
    if (!p.allFinite()) fail("a point that is not finite");
  const CheckedMesh checked = check_mesh(mesh, true);
  if (checked.error.empty() && checked.boundary.empty()) fail("a mesh without a surface");
  return 0;
}
