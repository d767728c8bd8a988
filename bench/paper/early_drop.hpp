#pragma once

#include <vector>

#include "bench/bench.hpp"
#include "pingvox/viewer/picture.hpp"

namespace pingvox::bench {

/// Figure 8 (section 5.3): gain from dropping updates that cannot change a cell, by density of the points.
Result<std::vector<Row>> paper_early_drop(const BenchOptions& options);

/// Figure 8: seconds by the number of points, without the drop and with it at each density.
Result<Picture> early_drop_chart();

}  // namespace pingvox::bench
