#include "head_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "option_values.hpp"

namespace pingvox::app {
namespace {

/// Steps of a motor in an angle; an error where they are no whole number of them.
Result<int> steps_in(double angle_deg, double step_deg, int max_steps) {
  const double steps = angle_deg / step_deg;
  if (steps > 0.5 && steps < max_steps + 0.5 && std::abs(steps - std::round(steps)) < 1e-6) {
    return static_cast<int>(std::lround(steps));
  }
  return usage_error(
      fmt::format("--step: must be a multiple of {} up to {:.4g}, is {}", step_deg, step_deg * max_steps, angle_deg));
}

/// Such a head would not turn, and its sweep would not end.
tl::unexpected<Error> step_beyond_sector(double step_deg) {
  return usage_error(fmt::format("--step: is {} degrees, more than --sector", step_deg));
}

}  // namespace

bool is_sector(const std::array<double, 2>& bearings_deg) {
  constexpr double kTurn_deg = 360.0;
  const auto& [from_deg, to_deg] = bearings_deg;
  return from_deg >= -kTurn_deg && to_deg <= kTurn_deg && to_deg - from_deg >= kGradian_deg &&
         to_deg - from_deg < kTurn_deg;
}

Result<void> apply(const HeadMotion& motion, Ping360Settings& head) {
  const Result<int> step = steps_in(motion.step_deg, kGradian_deg, 20);
  if (!step) return tl::unexpected(step.error());
  head.step_grad = *step;
  if (!motion.sector_deg) return {};
  const auto& [from_deg, to_deg] = *motion.sector_deg;
  const int width_grad = static_cast<int>(std::lround((to_deg - from_deg) / kGradian_deg));
  if (width_grad < *step) return step_beyond_sector(motion.step_deg);
  const int left_grad = 200 - static_cast<int>(std::lround(to_deg / kGradian_deg));
  head.sector = {.first_grad = (left_grad + 800) % 400, .width_grad = std::clamp(width_grad, 1, 399)};
  return {};
}

Result<void> apply(const HeadMotion& motion, MicronSettings& head) {
  constexpr int kTurn = 6400, kAhead = 3200;
  constexpr double kStep_deg = 360.0 / kTurn;
  const Result<int> step = steps_in(motion.step_deg, kStep_deg, 255);
  if (!step) return tl::unexpected(step.error());
  head.step = *step;
  if (!motion.sector_deg) return {};
  const auto angle = [](double bearing_deg) {
    return (kAhead - static_cast<int>(std::lround(bearing_deg / kStep_deg)) + 2 * kTurn) % kTurn;
  };
  const auto& [from_deg, to_deg] = *motion.sector_deg;
  if (to_deg - from_deg < motion.step_deg) return step_beyond_sector(motion.step_deg);
  head.sector = {.left = angle(to_deg), .right = angle(from_deg)};
  return {};
}

}  // namespace pingvox::app
