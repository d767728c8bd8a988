#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// All that the paper says and we can measure: the rows of all its benchmarks, and its figures where pictures are asked
/// for.
Result<std::vector<Row>> paper(const BenchOptions& options);

}  // namespace pingvox::bench
