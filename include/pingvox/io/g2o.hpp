#pragma once

#include <ostream>

#include "pingvox/geometry/pose_graph.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Writes a graph of poses as g2o, GTSAM and Ceres's examples read it: VERTEX_SE2 lines, whose names are the numbers of
/// the nodes, then EDGE_SE2 lines. Numbers are read back to the last bit.
/// @return kIo when `out` fails
Result<void> write_g2o(const PoseGraph& graph, std::ostream& out);

}  // namespace pingvox
