#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "pingvox/geometry/pose2.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/pose_graph.hpp"

namespace pingvox {

/// A pose of the path with the surroundings seen from it.
struct KeyFrame {
  Pose2 odometry;                         ///< map_from_vehicle, as measured
  std::vector<Eigen::Vector2d> points_m;  ///< what was seen around it, in its own frame
  std::size_t pass = 0;                   ///< a submap is of one pass: of key frames that follow each other
};

struct LoopOptions {
  double reach_m = 30.0;        ///< of the sensor, > 0; cells and distances are in proportion to it
  double window_m = 12.0;       ///< largest error of the present poses along each axis, 0..10 reaches
  double window_yaw_rad = 0.2;  ///< ... of their yaws, 0..pi
  /// Of one of two submaps, only points within so many reaches of its key frame are matched with the other: else the
  /// ends of the submaps would decide the match.
  double points_within = 3.0;  ///< > 0
  std::size_t first = 0;       ///< only this key frame and later ones are compared with those before them

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// Standard deviations of odometry over a stretch of way.
Eigen::Vector3d odometry_deviation(double moved_m, double turned_rad, double reach_m);

struct Loops {
  std::size_t found = 0;       ///< matches of submaps
  std::vector<PoseEdge> kept;  ///< those that agree with each other
};

/// Finds key frames that see the same surroundings although the way between them is long, by correlation of submaps
/// of nine key frames each. Loops are kept that agree with each other, given the odometry between them, and
/// that have another one near both of their ends: in doubt none. REQUIRES valid options, and finite points and poses.
/// @param poses  where each key frame is now
Loops find_loops(std::span<const KeyFrame> frames, std::span<const Pose2> poses, const LoopOptions& options);

}  // namespace pingvox
