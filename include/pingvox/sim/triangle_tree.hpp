#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "pingvox/geometry/mesh.hpp"

namespace pingvox {

/// A ray of sound.
struct SoundRay {
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< of length 1

  Eigen::Vector3d at(double range_m) const { return origin_m + range_m * direction; }
};

/// Nearer crossings are the surface that a ray starts on, and are ignored.
inline constexpr double kMinRange_m = 1e-6;

/// Whether a ray intersects a box within `limit_m`.
/// @param inverse  1 / direction, component by component; infinite where that is 0
bool intersects(const SoundRay& ray, const Eigen::Array3d& inverse, const Eigen::AlignedBox3d& box, double limit_m);

/// A mesh in a bounding volume hierarchy.
class TriangleTree {
 public:
  /// REQUIRES finite vertices, and indices that exist.
  explicit TriangleTree(TriangleMesh mesh);

  /// Called with each crossing; may lower the limit to skip farther ones.
  using Found = std::function<void(double range_m, const Eigen::Vector3d& normal, double& limit_m)>;
  /// All crossings with kMinRange_m < range <= limit_m, unordered. Normals have length 1 and either sign.
  void cross(const SoundRay& ray, double& limit_m, const Found& found) const;

  const TriangleMesh& mesh() const { return mesh_; }
  const Eigen::AlignedBox3d& bounds() const { return nodes_.front().box; }

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    std::uint32_t first = 0;  ///< leaf: first triangle; else first child, followed by the second
    std::uint32_t count = 0;  ///< triangles of a leaf; 0: two children
  };
  Eigen::AlignedBox3d box_of(std::size_t triangle) const;

  TriangleMesh mesh_;
  std::vector<Node> nodes_;  ///< the root first; never empty
};

}  // namespace pingvox
