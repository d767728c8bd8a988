#pragma once

#include <cstddef>
#include <utility>

#include "io/maps/octomap_pose.hpp"
#include "pingvox/map/point_scan.hpp"

namespace pingvox {

/// Whether a quaternion is a rotation: of length 1 within rounding.
bool is_rotation(const std::array<float, 4>& quaternion);

/// Collects the points of an OctoMap scan, transformed to the map frame.
class ScanBuilder {
 public:
  /// @param number  see PointScan
  ScanBuilder(const OctomapPose& pose, std::size_t number);

  bool origin_is_finite() const { return scan_.origin_m.allFinite(); }
  void reserve(std::size_t points) { scan_.points_m.reserve(points); }
  /// Adds a point; false if it is not finite in the map frame.
  bool add(const Point3f& point);
  PointScan finish() && { return std::move(scan_); }

 private:
  OctomapPose pose_;
  PointScan scan_;
};

}  // namespace pingvox
