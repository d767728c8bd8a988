#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// Section 8.1, figures 13 to 16: what smoothing does to the echoes.
Result<std::vector<Row>> paper_smoothing(const BenchOptions& options);

/// Section 8.2, figures 17 to 20: the thresholds, falling edges, and silent beams as walls.
Result<std::vector<Row>> paper_thresholds(const BenchOptions& options);

/// Section 9, figure 21: Canny.
Result<std::vector<Row>> paper_canny(const BenchOptions& options);

}  // namespace pingvox::bench
