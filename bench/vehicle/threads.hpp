#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// The bundles of tank-fine mapped by one thread and by two: the same map, and how much sooner it is there.
Result<std::vector<Row>> threads(const BenchOptions& options);

}  // namespace pingvox::bench
