#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// Section 5.1: bytes of a key, and what deeper trees cost, from 8 levels to 128.
Result<std::vector<Row>> paper_key_width(const BenchOptions& options);

}  // namespace pingvox::bench
