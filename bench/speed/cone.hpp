#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// Beams of the tank as cones, against insertPointCloud of their bundles of rays: what OctoMap has for them.
Result<std::vector<Row>> tank_cone(const BenchOptions& options);

}  // namespace pingvox::bench
