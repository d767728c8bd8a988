#include "nav/plausible_values.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/median.hpp"
#include "nav/depth_checks.hpp"
#include "nav/internal/upright.hpp"
#include "pingvox/geometry/degree.hpp"

namespace pingvox {
namespace {

/// Of one number of a quantity.
struct ValueLimit {
  std::string_view name, unit;  ///< of the number
  std::string_view limit;       ///< in words
  double min = 0.0, max = 0.0;
};

constexpr double kNoLimit = std::numeric_limits<double>::infinity();
/// Of angles: whole turns up to 2 pi, with the noise of a sensor around it.
constexpr double kMaxAngle_rad = 2.1 * std::numbers::pi;
constexpr double kMaxLatitude_rad = 1.001 * std::numbers::pi / 2.0;
/// The fastest rolls of small aircraft; vehicles in water turn by at most a third of it.
constexpr double kMaxTurnRate_rad_s = 15.0;
/// Twice that of small aircraft.
constexpr double kMaxSpeed_m_s = 100.0;
/// Half way round the Earth: beyond what any local frame, or UTM, has.
constexpr double kMaxPosition_m = 2e7;
/// The deepest sea is 10,935 m deep.
constexpr double kMaxDepth_m = 12'000.0, kMaxPressure_pa = 1.3e8;
/// Of water, air and electronics; Kelvins are beyond.
constexpr double kColdest_c = -100.0, kWarmest_c = 150.0;

constexpr ValueLimit symmetric(std::string_view name, std::string_view unit, std::string_view limit, double max) {
  return {name, unit, limit, -max, max};
}

constexpr ValueLimit kFree = symmetric("", "", "", kNoLimit);

std::array<ValueLimit, 3> limits_of(NavQuantity quantity) {
  const auto angle = [](std::string_view name) { return symmetric(name, "rad", "2 pi", kMaxAngle_rad); };
  const auto all = [](const ValueLimit& limit) { return std::array{limit, limit, limit}; };
  const auto first = [](const ValueLimit& limit) { return std::array{limit, kFree, kFree}; };
  switch (quantity) {
    case NavQuantity::kAttitude:
      return {angle("roll"), angle("pitch"), angle("yaw")};
    case NavQuantity::kHeading:
      return first(angle("yaw"));
    case NavQuantity::kTurnRate:
      return all(symmetric("turn rate", "rad/s", "15 rad/s", kMaxTurnRate_rad_s));
    case NavQuantity::kFix:
      return {symmetric("latitude", "rad", "pi/2", kMaxLatitude_rad), angle("longitude"), kFree};
    case NavQuantity::kVelocity:
      return all(symmetric("velocity", "m/s", "100 m/s", kMaxSpeed_m_s));
    case NavQuantity::kPosition:
      return all(symmetric("position", "m", "half a turn of the Earth", kMaxPosition_m));
    case NavQuantity::kDepth:
      return first(symmetric("depth", "m", "12 km", kMaxDepth_m));
    case NavQuantity::kPressure:
      return first(symmetric("pressure", "Pa", "that of the deepest sea", kMaxPressure_pa));
    case NavQuantity::kTemperature:
      return first({"temperature", "degrees C", "-100 to 150 degrees C", kColdest_c, kWarmest_c});
    case NavQuantity::kRange:
      break;  // nothing is computed from it
  }
  return all(kFree);
}

/// The first number that is not possible; nullopt: all are.
std::optional<std::size_t> impossible_number(const std::array<ValueLimit, 3>& limits, const Eigen::Vector3d& value) {
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const double number = value[static_cast<Eigen::Index>(i)];
    if (!(number >= limits[i].min && number <= limits[i].max)) return i;
  }
  return std::nullopt;
}

/// Whether an angle was a round number of degrees before it was brought to radians.
bool was_in_degrees(double angle_rad) {
  constexpr double kStep_deg = 0.01, kRounding = 1e-4;
  const double steps = angle_rad / kDegree_rad / kStep_deg;
  return std::fabs(steps - std::round(steps)) < kRounding;
}

/// "latitude of 54.3 rad is beyond pi/2: is it in degrees?", and where the log has degrees "latitude of 5418 degrees is
/// beyond pi/2: is it in another unit?"
std::string text_of(const ValueLimit& limit, double number) {
  constexpr double kMaxDegrees = 400.0;  // gradians, too
  if (limit.unit.starts_with("rad") && was_in_degrees(number)) {
    const bool may_be_longitude = limit.name == "latitude" && std::fabs(number) <= std::numbers::pi;
    return fmt::format("{} of {:.6g} degrees{} is beyond {}: is it {}in another unit?", limit.name,
                       number / kDegree_rad, limit.unit.substr(3), limit.limit,
                       may_be_longitude ? "the longitude, or " : "");
  }
  std::string text = fmt::format("{} of {:.6g} {} is beyond {}", limit.name, number, limit.unit, limit.limit);
  const bool is_angle = limit.unit.starts_with("rad");
  if (is_angle && std::fabs(number) <= kMaxDegrees) {
    return text + (limit.name == "yaw" ? ": is it in degrees, or does it count turns?" : ": is it in degrees?");
  }
  if (limit.unit == "degrees C" && number > 0.0) return text + ": is it in kelvins?";
  return text + ": is it in another unit?";
}

/// Finds out whether samples that are not possible are single ones.
class ImpossibleSamples {
 public:
  explicit ImpossibleSamples(NavQuantity quantity) : limits_(limits_of(quantity)) {}

  void add(const NavSample& sample) {
    if (!sample.valid) return;
    ++valid_;
    const std::optional<std::size_t> which = impossible_number(limits_, sample.value);
    if (!which) {
      row_ = 0;
      return;
    }
    ++impossible_;
    const double number = sample.value[static_cast<Eigen::Index>(*which)];
    const bool goes_on = row_ > 0 && *which == which_ && is_next(limits_[*which], number);
    row_ = goes_on ? row_ + 1 : 1;
    longest_row_ = std::max(longest_row_, row_);
    which_ = *which;
    before_ = number;
    if (text_.empty()) text_ = text_of(limits_[*which], number);
  }

  bool are_there() const { return impossible_ > 0; }
  /// Empty: they are single ones.
  std::string fault() const {
    constexpr std::size_t kRow = 3;
    return longest_row_ >= kRow || 2 * impossible_ > valid_ ? text_ : std::string();
  }

 private:
  /// Whether a number follows the one before as a measurement in another unit does: not twice the same, which stands
  /// for "not known" in some devices, and not anything, as a damaged number.
  bool is_next(const ValueLimit& limit, double number) const {
    constexpr double kLargestUnit = 1e3, kMaxStep = 0.5;
    const double largest = std::max(std::fabs(number), std::fabs(before_));
    const double step = std::fabs(number - before_);
    return largest <= kLargestUnit * limit.max && step > 0.0 && step <= kMaxStep * largest;
  }

  std::array<ValueLimit, 3> limits_;
  std::size_t valid_ = 0, impossible_ = 0, row_ = 0, longest_row_ = 0, which_ = 0;
  double before_ = 0.0;
  std::string text_;
};

/// How fast the vehicle turns on average [rad/s]; 0 for less than ten seconds.
double mean_turn_rate(const std::vector<NavSample>& samples) {
  constexpr double kMaxStep_s = 1.0, kShortest_s = 10.0;
  double turned_rad = 0.0, time_s = 0.0;
  const NavSample* before = nullptr;
  for (const NavSample& sample : samples) {
    if (!sample.valid) continue;
    if (before != nullptr) {
      const double step_s = std::min(sample.time_s - before->time_s, kMaxStep_s);
      turned_rad += step_s * before->value.norm();
      time_s += step_s;
    }
    before = &sample;
  }
  return time_s >= kShortest_s ? turned_rad / time_s : 0.0;
}

/// A turn in four seconds, all the time: the liveliest recording of a vehicle that we know has a third of it.
std::string fault_of_turning(const NavSource& source) {
  constexpr double kMaxMean_rad_s = 1.5;
  if (source.quantity != NavQuantity::kTurnRate) return {};
  const double mean_rad_s = mean_turn_rate(source.samples);
  if (!(mean_rad_s > kMaxMean_rad_s)) return {};
  return fmt::format("turn rate of {:.3g} rad/s on average: no vehicle turns as much: is it in degrees per second?",
                     mean_rad_s);
}

/// What a DVL writes where it knows nothing: the lowest number of 16 bits, in mm/s, on its axes.
bool is_not_known(const NavSource& source, const NavSample& sample) {
  constexpr double kMarker_m_s = 32.768, kRounding_m_s = 1e-6;
  if (source.quantity != NavQuantity::kVelocity) return false;
  return ((sample.value.head<2>().cwiseAbs().array() - kMarker_m_s).abs() < kRounding_m_s).all();
}

/// Faster than the fastest boats with a sonar, most of the time.
std::string fault_of_speed(const NavSource& source) {
  constexpr double kFastest_m_s = 10.0;
  if (source.quantity != NavQuantity::kVelocity) return {};
  std::vector<double> speeds_m_s;
  for (const NavSample& sample : source.samples) {
    if (sample.valid) speeds_m_s.push_back(sample.value.norm());
  }
  if (speeds_m_s.empty()) return {};
  const double usual_m_s = median(std::move(speeds_m_s));
  if (!(usual_m_s > kFastest_m_s)) return {};
  return fmt::format("velocity of {:.3g} m/s most of the time: is it in cm/s or mm/s?", usual_m_s);
}

std::string doubt_of_attitude(const NavSource& source) {
  if (source.quantity != NavQuantity::kAttitude || source.subject == NavSubject::kOther) return {};
  std::vector<Eigen::Vector3d> rpy;
  for (const NavSample& sample : source.samples) {
    if (sample.valid) rpy.push_back(sample.value);
  }
  return doubt_of_attitudes(rpy);
}

bool is_heading(const NavSource& source) {
  return source.quantity == NavQuantity::kAttitude || source.quantity == NavQuantity::kHeading;
}

double yaw_in(const NavSource& heading, const NavSample& sample) {
  return heading.quantity == NavQuantity::kAttitude ? sample.value.z() : sample.value.x();
}

/// A yaw that reads as degrees and is in radians begins anew within 6.28 degrees, while the vehicle turns on.
std::string fault_of_wrapping(const NavSource& source) {
  constexpr double kTurn_rad = 2.0 * std::numbers::pi * kDegree_rad, kNearly = 0.85, kMost = 1.02;
  if (!is_heading(source)) return {};
  std::vector<double> yaws_rad;
  for (const NavSample& sample : source.samples) {
    if (sample.valid) yaws_rad.push_back(yaw_in(source, sample));
  }
  if (yaws_rad.size() < 4) return {};
  const auto [least, most] = std::ranges::minmax(yaws_rad);
  if (most - least < kNearly * kTurn_rad || most - least > kMost * kTurn_rad) return {};
  for (std::size_t i = 2; i + 1 < yaws_rad.size(); ++i) {
    const double jump = yaws_rad[i] - yaws_rad[i - 1];
    const double before = yaws_rad[i - 1] - yaws_rad[i - 2], after = yaws_rad[i + 1] - yaws_rad[i];
    if (std::fabs(jump) >= kNearly * kTurn_rad && jump * before < 0.0 && jump * after < 0.0) {
      return "its yaw begins anew within 6.28 degrees, again and again: is it in radians?";
    }
  }
  return {};
}

bool tells_turns(const NavSource& source) {
  return is_usable(source) && (is_heading(source) || source.quantity == NavQuantity::kTurnRate);
}

double turn_between(const NavSource& heading, const NavSample& from, const NavSample& to) {
  return std::remainder(yaw_in(heading, to) - yaw_in(heading, from), 2.0 * std::numbers::pi);
}

/// How far a vehicle turned since the first sample [rad].
class TurnedYaw {
 public:
  explicit TurnedYaw(const NavSource& source) {
    double yaw_rad = 0.0;
    const NavSample* before = nullptr;
    for (const NavSample& sample : source.samples) {
      if (!sample.valid) continue;
      if (before != nullptr) {
        yaw_rad += is_heading(source) ? turn_between(source, *before, sample)
                                      : 0.5 * (sample.time_s - before->time_s) * (before->value.z() + sample.value.z());
      }
      before = &sample;
      times_s_.push_back(sample.time_s);
      yaws_rad_.push_back(yaw_rad);
    }
  }

  /// nullopt: it does not cover the time, or has no sample near it.
  std::optional<double> at(double time_s) const {
    constexpr double kNear_s = 1.0;
    const auto after = std::ranges::lower_bound(times_s_, time_s);
    if (after == times_s_.begin() || after == times_s_.end()) return std::nullopt;
    const auto i = static_cast<std::size_t>(after - times_s_.begin());
    const double step_s = times_s_[i] - times_s_[i - 1];
    if (step_s > kNear_s) return std::nullopt;
    const double share = (time_s - times_s_[i - 1]) / step_s;
    return yaws_rad_[i - 1] + share * (yaws_rad_[i] - yaws_rad_[i - 1]);
  }

 private:
  std::vector<double> times_s_, yaws_rad_;
};

/// How far a vehicle turns by another source for each radian that it turns by a heading; nullopt: they do not turn
/// together, or not enough to tell.
std::optional<double> turn_ratio(const TurnedYaw& other, const NavSource& heading) {
  constexpr double kStep_s = 1.0, kMaxStep_s = 3.0, kLeast_rad = 0.05, kLeastCorrelation = 0.9;
  constexpr std::size_t kFewest = 10;
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
  const bool is_enough = steps >= kFewest && std::min(by_heading, by_other) >= kLeast_rad * kLeast_rad;
  if (!is_enough || by_both * by_both < kLeastCorrelation * kLeastCorrelation * by_heading * by_other) {
    return std::nullopt;
  }
  return std::fabs(by_both) / by_heading;
}

}  // namespace

bool is_possible(NavQuantity quantity, const Eigen::Vector3d& value) {
  return !impossible_number(limits_of(quantity), value);
}

void check_values(NavSource& source) {
  if (!source.fault.empty()) return;
  for (NavSample& sample : source.samples) sample.valid = sample.valid && !is_not_known(source, sample);
  ImpossibleSamples found(source.quantity);
  for (const NavSample& sample : source.samples) found.add(sample);
  if (found.are_there()) {
    source.fault = found.fault();
    if (!source.fault.empty()) return;
    for (NavSample& sample : source.samples) sample.valid = sample.valid && is_possible(source.quantity, sample.value);
  }
  // Of one quantity each.
  source.fault = fault_of_turning(source) + fault_of_speed(source) + fault_of_depth(source) + fault_of_wrapping(source);
  source.doubt = doubt_of_attitude(source);
}

void compare_turns(std::span<NavSource> sources) {
  // Degrees to a radian, give or take what scale and mount of a sensor change.
  constexpr double kLeast = 45.0, kMost = 70.0;
  for (NavSource& one : sources) {
    if (!tells_turns(one)) continue;
    std::optional<TurnedYaw> turned;
    for (NavSource& heading : sources) {
      if (&one == &heading || !is_heading(heading) || !is_usable(heading)) continue;
      if (!turned) turned.emplace(one);
      const std::optional<double> ratio = turn_ratio(*turned, heading);
      if (!ratio) continue;
      const auto fault = [](const NavSource& faulty, const NavSource& other, double times) {
        return fmt::format("it turns {:.1f} times as far as the {} of {}: is it in degrees{}?", times,
                           name_of(other.quantity), other.name, is_heading(faulty) ? "" : " per second");
      };
      if (*ratio >= kLeast && *ratio <= kMost) {
        one.fault = fault(one, heading, *ratio);
        break;
      }
      if (*ratio >= 1.0 / kMost && *ratio <= 1.0 / kLeast) heading.fault = fault(heading, one, 1.0 / *ratio);
    }
  }
}

}  // namespace pingvox
