#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// Memory of the finished map of tank-3d.
Result<std::vector<Row>> memory(const BenchOptions& options);

}  // namespace pingvox::bench
