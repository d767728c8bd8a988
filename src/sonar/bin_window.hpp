#pragma once

#include <cstddef>
#include <vector>

#include "pingvox/sonar/detect_echo.hpp"

namespace pingvox {

/// The bins of a beam that may be evidence: those that lie beyond the minimum range as a whole. Empty
/// when begin >= end.
struct BinWindow {
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// One for each beam; the blanking range is found if it is not given.
std::vector<BinWindow> windows_of(const PolarImage& image, const Sweep& sweep, const EchoOptions& options);

/// The same windows without the bins that end farther away.
std::vector<BinWindow> windows_up_to(double max_range_m, std::vector<BinWindow> windows, const Sweep& sweep);

}  // namespace pingvox
