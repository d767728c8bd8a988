#include "nav/turn_checks.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "nav/internal/source_yaw.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/nav/nav_trajectory.hpp"

namespace pingvox {
namespace {

constexpr double kFullTurn_rad = 2.0 * std::numbers::pi;

bool gives_turns(const NavSource& source) {
  return is_usable(source) && (has_yaw(source) || source.quantity == NavQuantity::kTurnRate);
}

double turn_between(const NavSource& heading, const NavSample& from, const NavSample& to) {
  return std::remainder(yaw_of(heading, to) - yaw_of(heading, from), kFullTurn_rad);
}

/// How far a vehicle turned since the first sample [rad].
class TurnedYaw {
 public:
  /// @param near_s  longest step between samples
  explicit TurnedYaw(const NavSource& source, double near_s = 1.0) : near_s_(near_s) {
    double yaw_rad = 0.0;
    const NavSample* before = nullptr;
    for (const NavSample& sample : source.samples) {
      if (!sample.valid) continue;
      if (before != nullptr) {
        yaw_rad += has_yaw(source) ? turn_between(source, *before, sample)
                                   : 0.5 * (sample.time_s - before->time_s) * (before->value.z() + sample.value.z());
      }
      before = &sample;
      times_s_.push_back(sample.time_s);
      yaws_rad_.push_back(yaw_rad);
    }
  }

  /// nullopt: it does not cover the time, or has no sample near it.
  std::optional<double> at(double time_s) const {
    const auto after = std::ranges::lower_bound(times_s_, time_s);
    if (after == times_s_.begin() || after == times_s_.end()) return std::nullopt;
    const auto i = static_cast<std::size_t>(after - times_s_.begin());
    const double step_s = times_s_[i] - times_s_[i - 1];
    if (step_s > near_s_) return std::nullopt;
    const double share = (time_s - times_s_[i - 1]) / step_s;
    return yaws_rad_[i - 1] + share * (yaws_rad_[i] - yaws_rad_[i - 1]);
  }

  /// From the rightmost to the leftmost [rad].
  double range_rad() const {
    if (yaws_rad_.empty()) return 0.0;
    const auto [least, most] = std::ranges::minmax(yaws_rad_);
    return most - least;
  }

 private:
  double near_s_;
  std::vector<double> times_s_, yaws_rad_;
};

struct TurnRatio {
  double ratio = 0.0;       ///< how far a vehicle turns by another source for each radian by a heading
  double turned_rad = 0.0;  ///< by the heading, root of the sum of squares of steps of a second
};

/// nullopt: they do not turn together, or not enough to tell.
std::optional<TurnRatio> turn_ratio(const TurnedYaw& other, const NavSource& heading) {
  constexpr double kStep_s = 1.0, kMaxStep_s = 3.0, kMin_rad = 0.05, kMinCorrelation = 0.9;
  constexpr std::size_t kMinSteps = 10;
  double by_heading = 0.0, by_other = 0.0, by_both = 0.0;
  std::size_t steps = 0;
  const NavSample* before = nullptr;
  for (const NavSample& sample : heading.samples) {
    if (!sample.valid) continue;
    const double step_s = before != nullptr ? sample.time_s - before->time_s : 0.0;
    if (before != nullptr && step_s < kStep_s) continue;
    if (before != nullptr && step_s <= kMaxStep_s) {
      const auto from = other.at(before->time_s), to = other.at(sample.time_s);
      if (from && to) {
        const double turned_rad = turn_between(heading, *before, sample);
        by_heading += turned_rad * turned_rad;
        by_other += (*to - *from) * (*to - *from);
        by_both += turned_rad * (*to - *from);
        ++steps;
      }
    }
    before = &sample;
  }
  const bool is_enough = steps >= kMinSteps && std::min(by_heading, by_other) >= kMin_rad * kMin_rad;
  if (!is_enough || by_both * by_both < kMinCorrelation * kMinCorrelation * by_heading * by_other) {
    return std::nullopt;
  }
  return TurnRatio{by_both / by_heading, std::sqrt(by_heading)};
}

/// Whether a vehicle turns as far to the other side, with a clear margin.
bool is_opposite(const TurnRatio& turned) {
  constexpr double kMin = 0.5, kMax = 2.0, kClear_rad = 0.3;
  return turned.ratio <= -kMin && turned.ratio >= -kMax && turned.turned_rad >= kClear_rad;
}

bool may_be_vehicles(const NavSource& source) {
  return source.subject != NavSubject::kOther && is_usable(source);
}

/// Where a path leads, as a heading: between samples half a second apart or more, while it moves.
NavSource course_of(const NavSource& position) {
  constexpr double kStep_s = 0.5, kMaxStep_s = 2.5, kSlowest_m_s = 0.1;
  NavSource course{position.name, NavQuantity::kHeading, {}};
  const NavSample* before = nullptr;
  for (const NavSample& sample : position.samples) {
    if (!sample.valid) continue;
    const double step_s = before != nullptr ? sample.time_s - before->time_s : 0.0;
    if (before != nullptr && step_s < kStep_s) continue;
    if (before != nullptr && step_s <= kMaxStep_s) {
      const Eigen::Vector3d moved_m = position.quantity == NavQuantity::kFix
                                          ? position_of_fix(sample.value, before->value)
                                          : sample.value - before->value;
      if (moved_m.head<2>().norm() >= kSlowest_m_s * step_s) {
        course.samples.push_back(
            {.time_s = before->time_s + 0.5 * step_s, .value = {std::atan2(moved_m.y(), moved_m.x()), 0.0, 0.0}});
      }
    }
    before = &sample;
  }
  return course;
}

/// Whether a course is more than the noise of positions.
bool is_smooth(const NavSource& course) {
  constexpr double kMaxTurn_rad = 0.5, kMinShare = 0.95;
  std::size_t smooth = 0;
  for (std::size_t i = 1; i < course.samples.size(); ++i) {
    if (std::fabs(turn_between(course, course.samples[i - 1], course.samples[i])) <= kMaxTurn_rad) ++smooth;
  }
  return static_cast<double>(smooth) >= kMinShare * static_cast<double>(course.samples.size() - 1);
}

bool never_turns(const NavSource& attitude) {
  return std::ranges::all_of(attitude.samples,
                             [&](const NavSample& sample) { return sample.value == attitude.samples.front().value; });
}

/// Compares the headings with where a path leads. A vehicle may move to any side; but then it does not turn against its
/// path all the time, as far as it.
void compare_with_path(const NavSource& position, std::span<NavSource> sources) {
  constexpr double kNear_s = 2.5, kTurned_rad = std::numbers::pi / 2.0;
  constexpr std::size_t kMinSamples = 10;
  const NavSource course = course_of(position);
  if (course.samples.size() < kMinSamples) return;
  const TurnedYaw turned(course, kNear_s);
  for (NavSource& heading : sources) {
    if (!has_yaw(heading) || !may_be_vehicles(heading) || !heading.doubt.empty()) continue;
    if (never_turns(heading)) {
      const bool is_together = heading.samples.size() >= kMinSamples &&
                               heading.samples.front().time_s < course.samples.back().time_s &&
                               heading.samples.back().time_s > course.samples.front().time_s;
      if (!is_together || !is_smooth(course) || turned.range_rad() < kTurned_rad) continue;
      heading.doubt = fmt::format("it never turns, while the path of {} does: is it known?", position.name);
    } else if (const std::optional<TurnRatio> ratio = turn_ratio(turned, heading); ratio && is_opposite(*ratio)) {
      heading.doubt = fmt::format("its yaw turns against the path of {}: is it clockwise, or are rotations inverted?",
                                  position.name);
    }
  }
}

}  // namespace

void compare_turns(std::span<NavSource> sources) {
  // Degrees to a radian, give or take what scale and mount of a sensor change.
  constexpr double kMin = 45.0, kMax = 70.0;
  for (NavSource& one : sources) {
    if (!gives_turns(one)) continue;
    std::optional<TurnedYaw> turned;
    for (NavSource& heading : sources) {
      if (&one == &heading || !has_yaw(heading) || !is_usable(heading)) continue;
      if (!turned) turned.emplace(one);
      const std::optional<TurnRatio> found = turn_ratio(*turned, heading);
      if (!found) continue;
      if (is_opposite(*found) && may_be_vehicles(one) && may_be_vehicles(heading) && heading.doubt.empty()) {
        heading.doubt = fmt::format("its yaw turns against the {} of {}: is one of them clockwise?",
                                    name_of(one.quantity), one.name);
      }
      const double ratio = std::fabs(found->ratio);
      const auto fault = [](const NavSource& faulty, const NavSource& other, double times) {
        return fmt::format("it turns {:.1f} times as far as the {} of {}: is it in degrees{}?", times,
                           name_of(other.quantity), other.name, has_yaw(faulty) ? "" : " per second");
      };
      if (ratio >= kMin && ratio <= kMax) {
        one.fault = fault(one, heading, ratio);
        break;
      }
      if (ratio >= 1.0 / kMax && ratio <= 1.0 / kMin) heading.fault = fault(heading, one, 1.0 / ratio);
    }
  }
  for (const NavSource& position : sources) {
    const bool is_path = position.quantity == NavQuantity::kPosition || position.quantity == NavQuantity::kFix;
    if (is_path && may_be_vehicles(position)) compare_with_path(position, sources);
  }
}

}  // namespace pingvox
