#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// Section 5.6: bytes of the pruned cube, with eight pointers a node, with one, and as it really is.
Result<std::vector<Row>> paper_bytes(const BenchOptions& options);

}  // namespace pingvox::bench
