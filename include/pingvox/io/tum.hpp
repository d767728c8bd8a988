#pragma once

#include <ostream>

#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/io/bytes.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Reads a trajectory in the format of the TUM RGB-D benchmark: `t x y z qx qy qz qw` in each line, seconds and metres,
/// the pose of the body in the map frame. Separators are blanks, tabs or commas; lines with `#` are comments. One that
/// write_tum makes before the poses says which steps are gaps.
/// @return kCorrupt naming the first line that has not eight finite numbers, whose quaternion has not length
///         1 +- 0.001, or whose time does not come after the one before; kCorrupt when there is no pose
Result<Trajectory> read_tum(const FileBytes& file);

/// Writes all poses of a trajectory in that format, and which steps are gaps where it has some; times are read back to
/// the last bit. A trajectory that stands still is written as its one pose.
/// @return kIo when `out` fails
Result<void> write_tum(const Trajectory& trajectory, std::ostream& out);

}  // namespace pingvox
