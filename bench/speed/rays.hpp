#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// Random rays made keys, against computeRayKeys.
Result<std::vector<Row>> rays(const BenchOptions& options);

}  // namespace pingvox::bench
