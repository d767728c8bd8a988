#pragma once

#include <vector>

#include "bench.hpp"

namespace pingvox::bench {

/// Where `locate` finds a vehicle in a map, start unknown, compared with where it was: simulated drives, the recording
/// of a tank (if it is there; map of every other sweep, found in the rest), 100 random places of a harbour, and 100
/// kidnaps from one to the next. At last how fast poses are scored.
Result<std::vector<Row>> locate(const BenchOptions& options);

}  // namespace pingvox::bench
