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
#include <utility>
#include <vector>

#include "base/median.hpp"
#include "nav/depth_checks.hpp"
#include "nav/internal/source_yaw.hpp"
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
/// No depth, and no height that a map is made at; Earth-centred positions are beyond it but for near the equator.
constexpr double kMaxHeight_m = 1e5;
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
    case NavQuantity::kPosition: {
      const ValueLimit across = symmetric("position", "m", "half a turn of the Earth", kMaxPosition_m);
      return {across, across, symmetric("height", "m", "100 km", kMaxHeight_m)};
    }
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
  if (limit.name == "height") return text + ": are positions Earth-centred (ECEF), or in another unit?";
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

/// A yaw in radians that is read as degrees wraps within 6.28 degrees, while the vehicle turns on.
std::string fault_of_wrapping(const NavSource& source) {
  constexpr double kTurn_rad = 2.0 * std::numbers::pi * kDegree_rad, kNearly = 0.85, kMax = 1.02;
  if (!has_yaw(source)) return {};
  std::vector<double> yaws_rad;
  for (const NavSample& sample : source.samples) {
    if (sample.valid) yaws_rad.push_back(yaw_of(source, sample));
  }
  if (yaws_rad.size() < 4) return {};
  const auto [least, most] = std::ranges::minmax(yaws_rad);
  if (most - least < kNearly * kTurn_rad || most - least > kMax * kTurn_rad) return {};
  for (std::size_t i = 2; i + 1 < yaws_rad.size(); ++i) {
    const double jump = yaws_rad[i] - yaws_rad[i - 1];
    const double before = yaws_rad[i - 1] - yaws_rad[i - 2], after = yaws_rad[i + 1] - yaws_rad[i];
    if (std::fabs(jump) >= kNearly * kTurn_rad && jump * before < 0.0 && jump * after < 0.0) {
      return "its yaw repeatedly wraps within 6.28 degrees: is it in radians?";
    }
  }
  return {};
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
  if (std::string doubt = doubt_of_attitude(source); !doubt.empty()) source.doubt = std::move(doubt);
}

}  // namespace pingvox
