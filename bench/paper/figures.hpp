#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// The paper's figures 2 to 4, 8 to 12 and 13 to 21 as PNGs in options.pictures, of the simulated tank and, if present,
/// of the recording; a row for each file. kBadOption without options.pictures.
Result<std::vector<Row>> paper_figures(const BenchOptions& options);

}  // namespace pingvox::bench
