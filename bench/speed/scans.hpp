#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// The tank recording as scans of end points, against liboctomap's insertPointCloud.
Result<std::vector<Row>> tank_2d(const BenchOptions& options);
Result<std::vector<Row>> tank_3d(const BenchOptions& options);
Result<std::vector<Row>> tank_3d_cells(const BenchOptions& options);
Result<std::vector<Row>> tank_fine(const BenchOptions& options);
/// The beams as cones, against insertPointCloud of their bundles of rays.
Result<std::vector<Row>> tank_cone(const BenchOptions& options);
/// What the heap grows by for the finished map of tank-3d.
Result<std::vector<Row>> memory(const BenchOptions& options);

}  // namespace pingvox::bench
