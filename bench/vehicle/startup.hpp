#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// Time of `pingvox info` for a small map, from start to exit.
Result<std::vector<Row>> startup(const BenchOptions& options);

}  // namespace pingvox::bench
