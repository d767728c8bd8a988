#pragma once

#include <vector>

#include "bench.hpp"
#include "pingvox/result.hpp"
#include "report.hpp"

namespace pingvox::bench {

/// Echoes and maps of simulated recordings, held against what is true (docs/tuning.md).
Result<std::vector<Row>> accuracy(const BenchOptions& options);

}  // namespace pingvox::bench
