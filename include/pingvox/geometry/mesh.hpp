#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace pingvox {

/// Triangles that share their corners. The mesh may have holes, and its faces any orientation.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< each index is below vertices_m.size()
};

}  // namespace pingvox
