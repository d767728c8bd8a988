#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// Keys of random rays, compared with computeRayKeys.
Result<std::vector<Row>> rays(const BenchOptions& options);

}  // namespace pingvox::bench
