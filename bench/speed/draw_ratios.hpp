#pragma once

#include <string>
#include <vector>

#include "bench/report.hpp"
#include "pingvox/result.hpp"

namespace pingvox::bench {

/// Draws `speed.png` into a folder: for each row that has a ratio to liboctomap a bar, on a logarithmic axis. Nothing
/// is drawn when no row has one.
Result<void> draw_ratios(const std::vector<Row>& rows, const std::string& folder);

}  // namespace pingvox::bench
