#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// How long `pingvox info` takes for a small map, from its start to its end.
Result<std::vector<Row>> startup(const BenchOptions& options);

}  // namespace pingvox::bench
