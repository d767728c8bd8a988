#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// Queries of the map of tank-3d (tank_maps.hpp), the same for both.
Result<std::vector<Row>> look_up(const BenchOptions& options);
Result<std::vector<Row>> cast_rays(const BenchOptions& options);
Result<std::vector<Row>> leaves(const BenchOptions& options);

}  // namespace pingvox::bench
