#pragma once

#include <cmath>
#include <cstdint>

#include "pingvox/geometry/key.hpp"

namespace pingvox {

/// Whether cells are counted (CellAgreement): it takes more time, and memory for each cell.
enum class CountCells { kNo, kYes };

/// How well echoes that were held out of a map agree with one of its cells.
struct CellAgreement {
  WideKey cell;
  std::uint32_t judged = 0;  ///< echoes that may have come from it, or passed it
  std::uint32_t agreed = 0;  ///< of these, those that the map predicts by it

  /// Share of the echoes that agree. REQUIRES judged > 0
  double share() const { return static_cast<double>(agreed) / static_cast<double>(judged); }
  /// One byte for a picture: 0 is not judged, 1..255 the share from none to all.
  std::uint8_t level() const {
    constexpr double kSteps = 254.0;
    return judged == 0 ? std::uint8_t{0} : static_cast<std::uint8_t>(1 + std::lround(kSteps * share()));
  }
};

}  // namespace pingvox
