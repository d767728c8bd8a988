#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "pingvox/geometry/mesh.hpp"

namespace pingvox {

/// A way that sound takes: from a point in one direction, without end.
struct SoundRay {
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< of length 1

  Eigen::Vector3d at(double range_m) const { return origin_m + range_m * direction; }
};

/// Crossings nearer than this are the surface where a ray starts, and are left out.
inline constexpr double kLeastRange_m = 1e-6;

/// Whether a ray meets a box on its way from 0 to `limit_m`.
/// @param inverse  1 / direction, component by component; infinite where that is 0
bool meets(const SoundRay& ray, const Eigen::Array3d& inverse, const Eigen::AlignedBox3d& box, double limit_m);

/// A mesh in a tree of boxes, so that a ray looks at few of its triangles.
class TriangleTree {
 public:
  /// REQUIRES finite vertices, and indices that exist.
  explicit TriangleTree(TriangleMesh mesh);

  /// Told of each crossing; may lower the limit, so that what is farther is not looked at.
  using Found = std::function<void(double range_m, const Eigen::Vector3d& normal, double& limit_m)>;
  /// All crossings with kLeastRange_m < range <= limit_m, in no order. Normals are of length 1, either way round.
  void cross(const SoundRay& ray, double& limit_m, const Found& found) const;

  const TriangleMesh& mesh() const { return mesh_; }
  const Eigen::AlignedBox3d& bounds() const { return nodes_.front().box; }

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    std::uint32_t first = 0;  ///< of a leaf its first triangle, of others their first child; the second one follows
    std::uint32_t count = 0;  ///< triangles of a leaf; 0: two children
  };
  Eigen::AlignedBox3d box_of(std::size_t triangle) const;

  TriangleMesh mesh_;
  std::vector<Node> nodes_;  ///< the root first; never empty
};

}  // namespace pingvox
