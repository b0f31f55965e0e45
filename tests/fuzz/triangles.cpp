// Any bytes are a surface of triangles or are refused with a reason; what is closed has an inside.
#include <cstdio>
#include <cstdlib>

#include "read_triangles.h"

using namespace sutura;
using namespace sutura::contact;

namespace {

[[noreturn]] void fail(const char* what) {
  std::fprintf(stderr, "%s\n", what);
  std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const TriangleReading reading = read_triangle_text({reinterpret_cast<const char*>(data), size});
  if (reading.problem) {
    if (reading.problem->message.empty()) fail("an empty message");
    return 0;
  }
  if (reading.data.triangles.empty()) fail("no triangles");
  for (const auto& t : reading.data.triangles)
    for (const Index i : t)
      if (i < 0 || i >= static_cast<Index>(reading.data.points.size()))
        fail("an index out of range");
  for (const Vec3& p : reading.data.points)
    if (!p.allFinite()) fail("a point that is not finite");
  std::string error;
  const auto mesh = TriangleMesh::close(reading.data, error);
  if (mesh.has_value() != error.empty()) fail("neither a surface nor a reason");
  if (mesh) mesh->signed_distance(Vec3::Zero());
  return 0;
}
