#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// The map of a simulated harbour, of some ten million cells, added to another one: as it is, moved, and in other
/// cells. What is added is checked cell by cell for a sample of places.
Result<std::vector<Row>> merge(const BenchOptions& options);

}  // namespace pingvox::bench
