#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pingvox/result.hpp"

namespace pingvox {

/// End points of rays that were seen from one place: a scan of a laser, a multibeam, or one of OctoMap's scan logs.
/// In the map frame; with a time, in the frame of the sensor.
struct PointScan {
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> points_m;
  /// Rotation of the sensor: map_from_sensor. The identity where the log has none.
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  std::size_t number = 0;  ///< of the scan in its log, counted from 0, with those that were left out
  /// When it was taken [s]: the sensor's pose is that of a trajectory. nullopt: the scan is in the map frame.
  std::optional<double> time_s = std::nullopt;
  /// Whether the points are in the map frame although there is a time, which is for the sensor's pose only.
  bool has_points_in_map = false;
};

/// Scans in the order in which they were taken.
class ScanSource {
 public:
  virtual ~ScanSource() = default;
  /// The next scan; nullopt at the end; an error when nothing more can be read.
  virtual Result<std::optional<PointScan>> next() = 0;
  /// Points or scans left out so far because they were damaged.
  virtual std::size_t skipped() const { return 0; }
  /// Place and reason of the first one, as in "line 23: is not a point of three finite numbers"; empty: none.
  virtual std::string first_damage() const { return {}; }
  /// Deviations from the format in reading its points; empty: none. Known with the first scan.
  virtual std::string note() const { return {}; }
  /// Fraction read so far, 0..1, for a progress bar; nullopt if the size is unknown.
  virtual std::optional<double> share_read() const { return std::nullopt; }
};

}  // namespace pingvox
