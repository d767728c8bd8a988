#pragma once

#include <ostream>

#include "pingvox/geometry/mesh.hpp"
#include "pingvox/io/bytes.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Reads a mesh, told by content: OFF (text), PLY (text, binary of either order), STL (text, binary). Lengths are taken
/// to be metres. Faces of more than three corners become fans of triangles; colours, normals and the like are left out.
/// @return kCorrupt naming the place: a number that is missing or not finite, a corner that does not exist, no
///         triangle at all; kUnsupported for a file that is no mesh
Result<TriangleMesh> read_mesh(const FileBytes& file);

/// Writes a mesh as PLY, binary little-endian: double x, y, z, and faces as lists of uint.
/// @return kIo when `out` fails
Result<void> write_mesh_ply(const TriangleMesh& mesh, std::ostream& out);

}  // namespace pingvox
