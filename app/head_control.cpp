#include "head_control.hpp"

#include <optional>

#include "head_motion.hpp"
#include "option_values.hpp"

namespace pingvox::app {
namespace {

template <class Settings>
Result<void> apply_to(const web::live_control::DriveHead& control, double step_deg, Settings& head) {
  head.range_m = control.range_m.value_or(head.range_m);
  head.gain = control.gain.value_or(head.gain);
  if (control.is_full_turn) head.sector = std::nullopt;
  if (control.sector_deg && !is_sector(*control.sector_deg)) {
    return usage_error("the sector must be two bearings in degrees, the smaller one first, less than a turn apart");
  }
  const Result<void> moved = apply({control.step_deg.value_or(step_deg), control.sector_deg}, head);
  return moved ? head.validate() : moved;
}

}  // namespace

Result<void> apply(const web::live_control::DriveHead& control, LiveHead& head) {
  constexpr double kMicronStep_deg = 360.0 / 6400.0;
  if (head.kind == LiveHead::Kind::kMicron) return apply_to(control, head.micron.step * kMicronStep_deg, head.micron);
  return apply_to(control, head.ping360.step_grad * kGradian_deg, head.ping360);
}

}  // namespace pingvox::app
