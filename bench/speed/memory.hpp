#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// What the finished map of tank-3d takes in memory.
Result<std::vector<Row>> memory(const BenchOptions& options);

}  // namespace pingvox::bench
