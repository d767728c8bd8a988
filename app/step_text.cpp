#include "step_text.hpp"

#include <fmt/format.h>

#include "pingvox/geometry/degree.hpp"

namespace pingvox::app {

std::string step_text(const SourceStep& step) {
  const double seconds = step.to_s - step.from_s;
  if (step.is_new_start) {
    return fmt::format("is back at its origin, {:.1f} m away, after {:.2f} s, so its device restarted", step.moved_m,
                       seconds);
  }
  // Of poses with both, what the vehicle cannot do: a position jumps farther than a metre.
  constexpr double kMinJump_m = 1.0;
  if (step.moved_m >= kMinJump_m || step.turned_rad == 0.0) {
    return fmt::format("jumps by {:.1f} m in {:.2f} s", step.moved_m, seconds);
  }
  return fmt::format("turns by {:.0f} degrees in {:.2f} s", step.turned_rad / kDegree_rad, seconds);
}

}  // namespace pingvox::app
