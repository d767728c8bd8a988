#pragma once

#include <algorithm>

namespace pingvox {

/// A stretch of time on some clock [s].
struct TimeSpan {
  double from_s = 0.0, to_s = 0.0;

  double duration_s() const { return to_s - from_s; }
  /// How much of it lies between two times [s].
  double within(double begin_s, double end_s) const {
    return std::max(0.0, std::min(to_s, end_s) - std::max(from_s, begin_s));
  }
};

}  // namespace pingvox
