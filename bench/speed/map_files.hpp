#pragma once

#include <vector>

#include "bench/bench.hpp"

namespace pingvox::bench {

/// The map of tank-3d (tank_maps.hpp) as OctoMap's binary tree, written to and read from memory.
Result<std::vector<Row>> bt_write(const BenchOptions& options);
Result<std::vector<Row>> bt_read(const BenchOptions& options);

}  // namespace pingvox::bench
