#pragma once

#include <cstddef>
#include <optional>
#include <ostream>

#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Whose messages are written.
enum class McapMessages {
  kFoxglove,  ///< Protobuf: VoxelGrid, PointCloud, Grid, PosesInFrame, FrameTransform
  kRos2,      ///< CDR: Octomap, PointCloud2, OccupancyGrid, Path, TFMessage
};

/// What a recording is made of.
struct McapContents {
  std::optional<Trajectory> path = std::nullopt;  ///< map_from_body, times on the clock of the beams
  BeamSource* beams = nullptr;                    ///< nullptr: none
  Pose body_from_sonar = Pose::Identity();        ///< of the head of the beams
};

/// What was written.
struct McapCounts {
  std::size_t messages = 0, poses = 0, beams = 0;
};

/// Writes a map as an MCAP file for viewers: its occupied cells as points, in boxes of voxels (Foxglove) or as
/// OctoMap's trees (ROS 2), its columns as a grid; the path with its transforms, and each beam as points with
/// intensities. The map has the time of the first pose or beam.
/// @return kUnsupported when nothing is known or occupied, for ROS 2 also when the map has other than 16 levels, or
///         a time is negative; kLimit when the occupied cells span more boxes than there are topics for; the errors of
///         the beams; kNoMemory; kIo when `out` fails
Result<McapCounts> write_mcap(const OccupancyMap& map, const McapContents& contents, McapMessages messages,
                              std::ostream& out);

}  // namespace pingvox
