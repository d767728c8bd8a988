#pragma once

#include <chrono>
#include <cmath>

namespace pingvox::app {

/// Time since it was made.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

/// Rounded to microseconds.
inline double round_to_us(double seconds) {
  return std::round(seconds * 1e6) / 1e6;
}

}  // namespace pingvox::app
