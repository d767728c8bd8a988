#pragma once

#include <chrono>

namespace pingvox {

/// After this silence a topic counts as not connected.
inline constexpr double kRos2Silence_s = 5.0;
inline constexpr const char* kRos2Silent = "no message for 5 s";

/// Now, since 1970.
inline double system_now_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// Of a clock that never goes back.
inline double steady_now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace pingvox
