// The readers of the single formats, on a cursor over the bytes of a file. Their faults are thrown
// as FileProblem and caught in read_mesh_text; they do not leave this room.
#pragma once

#include "mesh_file.h"
#include "sutura/file_cursor.h"

namespace sutura::tissue {

// The readers, one per format; each throws FileProblem.
MeshData read_gmsh(FileCursor& in);
MeshData read_vtk_legacy(FileCursor& in);
MeshData read_vtu(std::string_view bytes);

}  // namespace sutura::tissue
