#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// How fast logs are read: megabytes a second of one core, from memory to beams.
Result<std::vector<Row>> log_reading(const BenchOptions& options);

}  // namespace pingvox::bench
