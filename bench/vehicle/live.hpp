#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// What `pingvox live` does with each beam of a Ping360 at a socket: time from the head's last byte to the beam's
/// cells.
Result<std::vector<Row>> live(const BenchOptions& options);

}  // namespace pingvox::bench
