#pragma once

#include <vector>

#include "bench.hpp"
#include "pingvox/result.hpp"
#include "report.hpp"

namespace pingvox::bench {

/// Echoes and maps of simulated recordings, compared with ground truth (docs/tuning.md).
Result<std::vector<Row>> accuracy(const BenchOptions& options);

}  // namespace pingvox::bench
