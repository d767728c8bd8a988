#pragma once

#include <vector>

#include "bench.hpp"

namespace pingvox::bench {

/// Trajectories of `slam`, compared with where the vehicle was: the recorded marina, if it is there, and the simulated
/// one. With pictures, the maps along dead reckoning and along `slam`.
Result<std::vector<Row>> slam(const BenchOptions& options);

}  // namespace pingvox::bench
