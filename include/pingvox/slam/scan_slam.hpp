#pragma once

#include <cstddef>
#include <memory>

#include "pingvox/geometry/pose_graph.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/map/point_scan.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

struct ScanSlamReport {
  std::size_t scans = 0, key_frames = 0;
  double reach_m = 0.0;    ///< range that nine of ten points are within; what is searched is in proportion to it
  std::size_t rounds = 0;  ///< of searching loops and moving the poses
  /// Loops that were found, and those of them that agree with each other, in the last round.
  std::size_t loops_found = 0, loops_kept = 0;
};

struct ScanSlamSolution {
  Trajectory trajectory;  ///< of the sensor, one pose a scan; its times are the numbers of the scans
  /// The key frames where they are in the end, odometry from each to the next, and the loops that were kept. The
  /// information of a loop has its final weight, so that plain least squares have the same solution.
  PoseGraph graph;
  ScanSlamReport report;
};

/// Corrects the poses of point scans (forward-looking sonars, lasers) whose poses are odometry: loops
/// are found by correlation of submaps, and a pose graph is solved, in rounds. Scans are matched
/// in the plane: they are to show walls rather than ground. Heights, rolls and pitches stay as they are
/// (docs/slam.md).
class ScanSlam {
 public:
  ScanSlam();
  ~ScanSlam();
  ScanSlam(ScanSlam&& other) noexcept;
  ScanSlam& operator=(ScanSlam&& other) noexcept;

  /// Points are expected in the map frame of the odometry, as scan logs are read.
  void add(const PointScan& scan);

  /// Can be called again after further scans. The first scan keeps its pose. Without loops the poses
  /// are those of the odometry.
  /// @return kUnsupported when there are fewer than two scans or no points; kCorrupt when the numbers of the scans do
  /// not rise
  Result<ScanSlamSolution> solve() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pingvox
