#pragma once

#include <vector>

#include "bench.hpp"

namespace pingvox::bench {

/// The recorded marina at 20 times its speed through what `live --slam` runs, compared with `slam --causal` of the same
/// recording and with where the vehicle was. Its row also has the processor time, and the memory that a beam takes
/// beside the map.
Result<std::vector<Row>> slam_on_board(const BenchOptions& options);

}  // namespace pingvox::bench
