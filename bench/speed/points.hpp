#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// A million normal points around key 10000, as in the paper's figure 8: the name holds their spread in
/// cells.
Result<std::vector<Row>> points_5000(const BenchOptions& options);
Result<std::vector<Row>> points_50(const BenchOptions& options);
Result<std::vector<Row>> points_5(const BenchOptions& options);

}  // namespace pingvox::bench
