#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// Beams of the tank as cones, compared with insertPointCloud of bundles of rays.
Result<std::vector<Row>> tank_cone(const BenchOptions& options);

}  // namespace pingvox::bench
