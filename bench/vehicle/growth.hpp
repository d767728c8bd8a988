#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// From an empty map to 100 million known cells: time to apply a small scan and memory per known cell. Also checks that
/// a map stays unchanged at its memory limit.
Result<std::vector<Row>> growth(const BenchOptions& options);

}  // namespace pingvox::bench
