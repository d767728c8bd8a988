#include "pingvox/mapping/build_options.hpp"

#include <fmt/core.h>

#include <cmath>
#include <string>

#include "mapping/internal/option_limits.hpp"
#include "sonar/internal/option_limits.hpp"

namespace pingvox {
namespace {

/// Checks what beams and points have in common.
std::string common_errors(const BuildOptions& options) {
  std::string bad;
  const auto say = [&bad](const std::string& what) { bad += (bad.empty() ? "" : "; ") + what; };
  if (const auto model = options.model.validate(); !model) say(model.error().message);
  if (!(options.miss < LogOdds(0.0F)) || !std::isfinite(options.miss.value())) {
    say(fmt::format("miss must be a probability {}, is {:.6g}", kMisses.text(), options.miss.probability()));
  }
  if (options.threads < 1 || options.threads > 256)
    say(fmt::format("threads must be in 1..256, are {}", options.threads));
  return bad;
}

Result<void> result_of(const std::string& bad) {
  if (bad.empty()) return {};
  return fail(Error::Code::kBadOption, bad);
}

}  // namespace

Result<void> BuildOptions::validate() const {
  std::string bad;
  const auto say = [&bad](const std::string& what) { bad += (bad.empty() || what.empty() ? "" : "; ") + what; };
  for (const Result<void>& part : {filter.validate(), echo.validate()}) {
    if (!part) say(part.error().message);
  }
  say(common_errors(*this));
  if (!body_from_sensor.matrix().allFinite()) say("mount is not finite");
  if (!kSoundSpeedRatios.contain(sound_speed_ratio)) {
    say(fmt::format("sound speed must be {} times what the device assumed, is {} times", kSoundSpeedRatios.text(),
                    sound_speed_ratio));
  }
  if (timing == Timing::kByBeam && vote != Vote::kPerBeam) say("beams that are mapped one by one need a vote per beam");
  return result_of(bad);
}

Result<void> BuildOptions::validate_for_points() const {
  std::string bad = common_errors(*this);
  if (!kFarthestRanges_m.contain(echo.max_range_m)) {
    bad += fmt::format("{}max_range_m must be {}, is {}", bad.empty() ? "" : "; ", kFarthestRanges_m.text(),
                       echo.max_range_m);
  }
  return result_of(bad);
}

}  // namespace pingvox
