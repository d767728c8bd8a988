#pragma once

#include <Eigen/Core>
#include <span>

#include "pingvox/cloud/trace_points.hpp"
#include "pingvox/map/log_odds.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

struct InsertOptions {
  PointScanOptions scan;
  LogOdds miss = LogOdds::from_probability(0.4);  ///< evidence for a cell that a ray passes through
};

struct InsertReport {
  ApplyReport applied;
  std::size_t outside = 0;  ///< points outside of the lattice; all of them, if the origin is
};

/// Inserts a point cloud [m, map frame] seen from `origin_m` into a map, as OctoMap's insertPointCloud does: the cell
/// of each point is hit, the cells before it are missed, a hit beats a miss, each cell is updated once. For many clouds
/// a PointTracer with a ScanUpdate is faster: it reuses its memory.
/// @return kLimit when the map's memory limit would be passed, or as for check_rays; kNoMemory as for
/// OccupancyMap::apply
Result<InsertReport> insert_points(OccupancyMap& map, const Eigen::Vector3d& origin_m,
                                   std::span<const Eigen::Vector3d> points_m, const InsertOptions& options = {});
/// The same for points in single precision.
Result<InsertReport> insert_points(OccupancyMap& map, const Eigen::Vector3d& origin_m,
                                   std::span<const Eigen::Vector3f> points_m, const InsertOptions& options = {});

}  // namespace pingvox
