#pragma once

#include <array>

namespace pingvox {

/// A point as OctoMap holds it.
using Point3f = std::array<float, 3>;

/// The pose of a scan as OctoMap holds it and computes with it. Its tools transform scans in single precision, and
/// which cell a point falls into depends on each rounding: this repeats their arithmetic, operation by operation, so
/// that the same file gives the same points. Everywhere else pingvox uses Pose.
struct OctomapPose {
  Point3f translation = {0.0F, 0.0F, 0.0F};
  std::array<float, 4> rotation = {1.0F, 0.0F, 0.0F, 0.0F};  ///< quaternion, real part first

  /// From fixed-axis roll, pitch, yaw [rad], as in `pose_from_rpy`.
  static OctomapPose from_rpy(const Point3f& translation, float roll_rad, float pitch_rad, float yaw_rad);

  /// A point of the scan in the frame of the map.
  Point3f transform(const Point3f& point) const;

  /// Where graph2tree starts the rays of a scan: not at the translation, but at what is left of it after a way to the
  /// scan's own frame and back.
  Point3f ray_origin() const;
};

}  // namespace pingvox
