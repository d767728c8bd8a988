#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// The cube of 100^3 cells of the paper's Table 1: every cell updated once as occupied.
Result<std::vector<Row>> cube_each(const BenchOptions& options);
Result<std::vector<Row>> cube_lazy(const BenchOptions& options);

}  // namespace pingvox::bench
