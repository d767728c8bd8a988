#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// Section 6, figures 9 to 12: which cells Bresenham and DDA miss, how often the paper's own DDA loses its end, and
/// what each costs.
Result<std::vector<Row>> paper_rays(const BenchOptions& options);

}  // namespace pingvox::bench
