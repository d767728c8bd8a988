#include "slam/smoother/sonar_checks.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "nav/internal/yaw_clock.hpp"
#include "slam/smoother/slam_input.hpp"

namespace pingvox {
namespace {

std::optional<VelocityCheck> velocity_check(const VelocitySource& velocity, const HeadingSource& heading,
                                            std::span<const SweepEchoes> sweeps, const SlamOptions& options) {
  constexpr std::size_t kSweeps = 60;  // those in the middle: they tell a sensor that is wrong
  if (velocity.by_sonar || sweeps.size() < 2) return std::nullopt;
  const std::size_t count = std::min(kSweeps, sweeps.size());
  return check_velocity(velocity, sweeps.subspan((sweeps.size() - count) / 2, count),
                        velocity_from_sonar(velocity, options), heading);
}

}  // namespace

SonarChecks checks_of(const VelocitySource& velocity, const HeadingSource& heading, std::span<const SweepEchoes> sweeps,
                      PictureTurns turns, const SlamOptions& options) {
  if (options.matching == Matching::kNone) return {};
  SonarChecks checks{velocity_check(velocity, heading, sweeps, options), std::nullopt};
  if (heading.by_sonar) return checks;
  const std::vector<YawChange> changes = turns.finish();
  checks.clock = clock_error(changes, turns.pauses(), heading.yaw_rad);
  return checks;
}

void report_checks(const SonarChecks& checks, SlamReport& report) {
  const auto& [velocity, clock] = checks;
  if (velocity) report.velocity.check = SonarCheck{velocity->matched, velocity->difference_m_s};
  report.clock_check = clock;
  if (checks.contradict_velocity()) {
    report.implausible.push_back(fmt::format("velocity of {} ({:.2f} m/s from what {} sweeps see, in the median)",
                                             report.velocity.source, velocity->difference_m_s, velocity->matched));
  }
  if (clock && clock->from_s) {
    report.implausible.push_back(
        fmt::format("clock of {} (jumps ahead by {:.1f} +- {:.1f} s at {:.1f} s, from the rotation of the sonar image)",
                    clock->offset_s < 0.0 ? report.heading : "the sonar", std::abs(clock->offset_s), clock->deviation_s,
                    *clock->from_s));
  } else if (clock && clock->is_apart()) {
    report.implausible.push_back(fmt::format("clock of {} ({:+.1f} +- {:.1f} s{} from the rotation of the sonar image)",
                                             report.heading, clock->offset_s, clock->deviation_s,
                                             clock->is_one_of_several ? ", or another," : ""));
  }
}

}  // namespace pingvox
