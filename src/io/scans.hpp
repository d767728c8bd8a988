#pragma once

#include <cstddef>
#include <utility>

#include "io/octomap_pose.hpp"
#include "pingvox/map/point_scan.hpp"

namespace pingvox {

/// Whether a quaternion stands for a rotation: of length 1, but for rounding.
bool is_rotation(const std::array<float, 4>& quaternion);

/// Collects the points of one of OctoMap's scans, moved to the frame of the map.
class ScanBuilder {
 public:
  explicit ScanBuilder(const OctomapPose& pose);

  bool origin_is_finite() const { return scan_.origin_m.allFinite(); }
  void reserve(std::size_t points) { scan_.points_m.reserve(points); }
  /// false, and nothing added: the point is not finite in the frame of the map.
  bool add(const Point3f& point);
  PointScan finish() && { return std::move(scan_); }

 private:
  OctomapPose pose_;
  PointScan scan_;
};

}  // namespace pingvox
