#pragma once

#include <ostream>

#include "pingvox/geometry/mesh.hpp"
#include "pingvox/io/bytes.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Reads a mesh: OFF (text), PLY (text, binary of either byte order) or STL (text, binary), by content. Units are
/// metres. Faces of more than three corners become fans of triangles; colours, normals and the like are ignored.
/// @return kCorrupt naming the place: a missing or non-finite number, an index out of range, no triangle;
///         kUnsupported if the file is not a mesh
Result<TriangleMesh> read_mesh(const FileBytes& file);

/// Writes a mesh as PLY, binary little-endian: double x, y, z, and faces as lists of uint.
/// @return kIo when `out` fails
Result<void> write_mesh_ply(const TriangleMesh& mesh, std::ostream& out);

}  // namespace pingvox
