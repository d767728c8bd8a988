#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// From a scan graph to a map as whole programs: `pingvox map` against OctoMap's graph2tree.
Result<std::vector<Row>> command(const BenchOptions& options);

}  // namespace pingvox::bench
