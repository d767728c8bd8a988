#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// From an empty map to 100 million known cells: what a small scan takes to apply, and the memory of a known cell. And
/// that a map with a limit stops there, unchanged.
Result<std::vector<Row>> growth(const BenchOptions& options);

}  // namespace pingvox::bench
