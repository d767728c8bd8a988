#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// The tank recording beam by beam (tank-2d) or as scans of end points, compared with insertPointCloud.
Result<std::vector<Row>> tank_2d(const BenchOptions& options);
Result<std::vector<Row>> tank_3d(const BenchOptions& options);
Result<std::vector<Row>> tank_3d_cells(const BenchOptions& options);
Result<std::vector<Row>> tank_fine(const BenchOptions& options);

/// Clouds of a multibeam and of spinning lidars, compared with insertPointCloud.
Result<std::vector<Row>> multibeam(const BenchOptions& options);
Result<std::vector<Row>> lidar_16(const BenchOptions& options);
Result<std::vector<Row>> lidar_128(const BenchOptions& options);

}  // namespace pingvox::bench
