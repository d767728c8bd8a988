#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// Figure 8 (section 5.3): what it brings to drop updates that cannot change a cell, by how dense the points are.
Result<std::vector<Row>> paper_early_drop(const BenchOptions& options);

}  // namespace pingvox::bench
