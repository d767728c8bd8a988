#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// The tank recording beam by beam as a vehicle would map it: how long until a beam is in the map, and what share of a
/// core that takes.
Result<std::vector<Row>> realtime(const BenchOptions& options);

}  // namespace pingvox::bench
