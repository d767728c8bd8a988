#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// Table 1: nodes of the cube without pruning, with it, and with it at the end; and the times of the three ways.
Result<std::vector<Row>> paper_table_1(const BenchOptions& options);

}  // namespace pingvox::bench
