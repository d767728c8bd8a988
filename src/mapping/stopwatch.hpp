#pragma once

#include <chrono>

namespace pingvox::detail {

/// Adds the time since the last lap to one stage after the other.
class Stopwatch {
 public:
  void lap(double& stage_s) {
    const auto now = Clock::now();
    stage_s += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }
  void skip() { last_ = Clock::now(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

}  // namespace pingvox::detail
