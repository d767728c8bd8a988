#pragma once

#include <string>
#include <vector>

#include "pingvox/result.hpp"
#include "report.hpp"

namespace pingvox::bench {

/// Draws the rows of `accuracy` as bar charts, accuracy-echoes.png and accuracy-maps.png, into a folder, which is made
/// if it is not there.
Result<void> draw_accuracy(const std::vector<Row>& rows, const std::string& folder);

}  // namespace pingvox::bench
