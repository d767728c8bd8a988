#pragma once

#include <string>
#include <vector>

#include "bench/report.hpp"
#include "pingvox/result.hpp"

namespace pingvox::bench {

/// Draws `speed.png` into a folder: a bar for each row with a ratio to liboctomap, on a logarithmic axis. Draws nothing
/// if there is none.
Result<void> draw_ratios(const std::vector<Row>& rows, const std::string& folder);

}  // namespace pingvox::bench
