#pragma once

#include <cstdint>
#include <span>
#include <sstream>
#include <string>

#include "fuzz/bodies/require.hpp"
#include "pingvox/io/mesh.hpp"

namespace pingvox::fuzz {

/// Any bytes as a mesh: what is read is finite and has the corners that it names, no more of them than the bytes hold,
/// and is written and read back.
/// @return triangles read
inline std::size_t mesh(std::span<const std::uint8_t> bytes) {
  const auto read = read_mesh({"fuzzed", {bytes.begin(), bytes.end()}});
  if (!read) {
    require(read.error().message.starts_with("fuzzed"), "an error names the file");
    require(read.error().message.find('\n') == std::string::npos, "an error is one line");
    return 0;
  }
  require(!read->triangles.empty(), "a mesh has triangles");
  require(read->vertices_m.size() <= bytes.size() / 3 && read->triangles.size() <= bytes.size(),
          "no more is read than there is");
  for (const Eigen::Vector3d& vertex : read->vertices_m) require(vertex.allFinite(), "vertices are finite");
  for (const auto& triangle : read->triangles) {
    for (const std::uint32_t corner : triangle) require(corner < read->vertices_m.size(), "corners exist");
  }
  std::stringstream out;
  require(write_mesh_ply(*read, out).has_value(), "what is read is written");
  const std::string written = out.str();
  const auto back = read_mesh({"written", {written.begin(), written.end()}});
  require(back && back->vertices_m == read->vertices_m && back->triangles == read->triangles,
          "what is read is what was written");
  return read->triangles.size();
}

}  // namespace pingvox::fuzz
