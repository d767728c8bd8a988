#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

Result<std::vector<Row>> day(const BenchOptions& options);

}  // namespace pingvox::bench
