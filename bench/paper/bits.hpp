#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// Section 7: what the two bits of a child in a .bt file are.
Result<std::vector<Row>> paper_bits(const BenchOptions& options);

}  // namespace pingvox::bench
