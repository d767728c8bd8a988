#include "slam_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "option_values.hpp"
#include "pingvox/geometry/degree.hpp"

namespace pingvox::app {
namespace {

constexpr std::array kMatchings = {Choice<Matching>{"pairs", Matching::kPairs},
                                   Choice<Matching>{"none", Matching::kNone}};

/// "anywhere", or x, y, yaw, and optionally their standard deviations: metres and degrees.
Take store_start(std::optional<StartPose>& target) {
  return [&target](const std::string& text) -> Result<void> {
    target.reset();
    if (text == "anywhere") return {};
    StartPose start;
    const auto commas = std::ranges::count(text, ',');
    if (commas == 4) {
      const auto numbers = numbers_from<5>(text);
      if (!numbers) return tl::unexpected(numbers.error());
      const auto& n = *numbers;
      start = {n[0], n[1], n[2] * kDegree_rad, n[3], n[4] * kDegree_rad};
    } else if (commas == 2) {
      const auto numbers = numbers_from<3>(text);
      if (!numbers) return tl::unexpected(numbers.error());
      const auto& n = *numbers;
      start.x_m = n[0];
      start.y_m = n[1];
      start.yaw_rad = n[2] * kDegree_rad;
    } else {
      return usage_error(fmt::format("'{}': must be anywhere, X,Y,YAW or X,Y,YAW,SIGMA_M,SIGMA_DEG", text));
    }
    constexpr double kFar_m = 1e6;
    const bool is_good = std::abs(start.x_m) <= kFar_m && std::abs(start.y_m) <= kFar_m &&
                         std::isfinite(start.yaw_rad) && start.deviation_m >= 0.0 && start.deviation_m <= kFar_m &&
                         start.deviation_rad >= 0.0 && std::isfinite(start.deviation_rad);
    if (!is_good) return usage_error(fmt::format("'{}': a number is out of range", text));
    target = start;
    return {};
  };
}

}  // namespace

std::vector<Option> slam_options(SlamOptions& slam, Estimation& estimation) {
  Option seed{"--seed", 0,
              "N",      "seed of the random choice of sweeps that a sweep is matched with",
              "1",      store_number(slam.seed)};
  seed.only_with = {{"--matching", {"pairs"}}};
  return {choice("--matching", kMatchings, "match pairs of echoes of different sweeps; none: dead reckoning only",
                 slam.matching),
          flag("--causal", "estimate each pose only from what was recorded before it, as on board", estimation,
               Estimation::kCausal),
          std::move(seed)};
}

std::vector<Option> locate_options(LocalizerOptions& localizer, Estimation& estimation) {
  return {flag("--causal", "estimate each pose only from what was recorded before it, as on board", estimation,
               Estimation::kCausal),
          {"--seed", 0, "N", "seed of the random numbers", "1", store_number(localizer.seed)}};
}

std::vector<Option> height_options(std::optional<double>& min_z_m, std::optional<double>& max_z_m) {
  return {{"--min-z", 0, "M", "lowest height of the map that is used", "0.5 below the sonar at the first beam",
           store_optional(min_z_m)},
          {"--max-z", 0, "M", "highest height of the map that is used", "0.5 above the sonar at the first beam",
           store_optional(max_z_m)}};
}

Option start_option(std::optional<StartPose>& start) {
  return {"--start",
          0,
          "X,Y,YAW[,SIGMA_M,SIGMA_DEG]",
          "first pose of the vehicle in metres and degrees, with standard deviations (0.5,10); or anywhere",
          "anywhere",
          store_start(start)};
}

}  // namespace pingvox::app
