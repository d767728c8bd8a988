#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// Maps the tank recording beam by beam: latency of a beam, and load of a core.
Result<std::vector<Row>> realtime(const BenchOptions& options);

}  // namespace pingvox::bench
