#pragma once

#include <cstddef>
#include <vector>

#include "pingvox/sonar/detect_echo.hpp"

namespace pingvox {

/// The bins of a beam that lie entirely beyond the minimum range. Empty when begin >= end.
struct BinWindow {
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// One for each beam. REQUIRES a minimum range.
std::vector<BinWindow> windows_of(const PolarImage& image, const Sweep& sweep, const EchoOptions& options);

/// The same windows without the bins that end beyond max_range_m.
std::vector<BinWindow> clip_windows(double max_range_m, std::vector<BinWindow> windows, const Sweep& sweep);

}  // namespace pingvox
