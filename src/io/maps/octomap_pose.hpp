#pragma once

#include <array>

namespace pingvox {

/// A point in OctoMap's precision.
using Point3f = std::array<float, 3>;

/// The pose of a scan with OctoMap's arithmetic: single precision, operation by operation, because rounding decides
/// which cell a point falls into. Everything else uses Pose.
struct OctomapPose {
  Point3f translation = {0.0F, 0.0F, 0.0F};
  std::array<float, 4> rotation = {1.0F, 0.0F, 0.0F, 0.0F};  ///< quaternion, real part first

  /// From fixed-axis roll, pitch, yaw [rad], as in `pose_from_rpy`.
  static OctomapPose from_rpy(const Point3f& translation, float roll_rad, float pitch_rad, float yaw_rad);

  /// Transforms a point of the scan to the map frame.
  Point3f transform(const Point3f& point) const;

  /// Origin of the rays in graph2tree: the translation after a round trip through the scan's frame.
  Point3f ray_origin() const;
};

}  // namespace pingvox
