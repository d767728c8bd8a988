#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// All measurable claims of the paper: the rows of its benchmarks, and its figures if options.pictures is set.
Result<std::vector<Row>> paper(const BenchOptions& options);

}  // namespace pingvox::bench
