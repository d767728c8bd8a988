#pragma once

#include <vector>

#include "bench/bench.hpp"
#include "pingvox/viewer/picture.hpp"

namespace pingvox::bench {

/// Section 3: a dense grid, lines and corners, and the octree, made of the same sweeps: memory, time, and how well a
/// vehicle is followed in each. Simulated tank and harbour, and the recorded tank where it is there.
Result<std::vector<Row>> paper_maps(const BenchOptions& options);

/// The harbour's octree beside its lines.
Result<Picture> harbour_and_its_lines();

}  // namespace pingvox::bench
