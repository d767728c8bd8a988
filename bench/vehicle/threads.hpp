#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// The bundles of tank-fine mapped by one thread and by two: equal maps, and the speed-up.
Result<std::vector<Row>> threads(const BenchOptions& options);

}  // namespace pingvox::bench
