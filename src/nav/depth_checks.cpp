#include "nav/depth_checks.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "base/median.hpp"
#include "nav/number_extent.hpp"
#include "nav/water_column.hpp"

namespace pingvox {
namespace {

using Pairs = std::vector<std::pair<double, double>>;

/// The depth by the pressure that rises highest; nullopt: none is that of water.
std::optional<NavSource> depth_by_pressure(std::span<const NavSource> sources) {
  const NavSource* chosen = nullptr;
  double highest_pa = kMaxInAir_pa;
  for (const NavSource& source : sources) {
    if (source.quantity != NavQuantity::kPressure || source.subject == NavSubject::kOther || !is_usable(source))
      continue;
    const std::optional<NumberExtent> numbers = extent_of(source);
    if (!numbers || numbers->highest <= highest_pa) continue;
    highest_pa = numbers->highest;
    chosen = &source;
  }
  if (chosen == nullptr) return std::nullopt;
  NavSource depth = *chosen;
  for (NavSample& sample : depth.samples) sample.value.x() = depth_of_pressure(sample.value.x());
  return depth;
}

double median_of(const Pairs& pairs, double std::pair<double, double>::* which) {
  std::vector<double> numbers;
  for (const auto& pair : pairs) numbers.push_back(pair.*which);
  return median(std::move(numbers));
}

/// By how much the second numbers of pairs change where the first ones change by 1; nullopt: they do not change
/// together, or not enough to tell.
std::optional<double> slope_of(const Pairs& pairs) {
  constexpr std::size_t kMinPairs = 10;
  constexpr double kMin_m = 0.08, kMinCorrelation = 0.95;
  if (pairs.size() < kMinPairs) return std::nullopt;
  const auto count = static_cast<double>(pairs.size());
  double mean_a = 0.0, mean_b = 0.0;
  for (const auto& [a, b] : pairs) {
    mean_a += a / count;
    mean_b += b / count;
  }
  double aa = 0.0, bb = 0.0, ab = 0.0;
  for (const auto& [a, b] : pairs) {
    aa += (a - mean_a) * (a - mean_a) / count;
    bb += (b - mean_b) * (b - mean_b) / count;
    ab += (a - mean_a) * (b - mean_b) / count;
  }
  const bool is_enough = std::min(aa, bb) >= kMin_m * kMin_m;
  if (!is_enough || ab * ab < kMinCorrelation * kMinCorrelation * aa * bb) return std::nullopt;
  return ab / aa;
}

/// "feet", where a number of metres that is so many times too large is one of feet; empty: it is in no usual unit.
std::string_view unit_of(double times) {
  constexpr double kTolerance = 0.04;  // fresh water and salt water differ by less
  constexpr std::array kUnits = {
      std::pair{3.2808, std::string_view("feet")}, std::pair{0.5468, std::string_view("fathoms")},
      std::pair{10.0, std::string_view("dm")},     std::pair{100.0, std::string_view("cm")},
      std::pair{1000.0, std::string_view("mm")},   std::pair{0.1, std::string_view("another unit")}};
  for (const auto& [per_metre, name] : kUnits) {
    if (std::fabs(times / per_metre - 1.0) <= kTolerance) return name;
  }
  return {};
}

/// ": is it in feet?"
std::string unit_question(double times) {
  const std::string_view unit = unit_of(times);
  return unit.empty() ? "" : fmt::format(": is it in {}?", unit);
}

/// What differs by less may be another water or another place on the vehicle.
bool is_as_much(double times) {
  constexpr double kMin = 0.5, kMax = 2.0;
  return times >= kMin && times <= kMax && unit_of(times).empty();
}

/// Where a depth is a hundred or a thousand times that by the pressure.
std::string fault_by_pressure(const NavSource& depth, const NavSource& by_pressure) {
  constexpr std::size_t kMinPairs = 3;
  constexpr double kMin_m = 1.0, kZeros_m = 15.0, kMinTimes = 50.0, kMaxTimes = 2000.0;
  const Pairs pairs = numbers_together(depth, by_pressure);
  if (pairs.size() < kMinPairs) return {};
  const double depth_m = median_of(pairs, &Pairs::value_type::first);
  const double by_pressure_m = median_of(pairs, &Pairs::value_type::second);
  // The zero of a pressure may be ten metres off, that of air.
  if (by_pressure_m < kMin_m || std::fabs(depth_m - by_pressure_m) < kZeros_m) return {};
  const double times = depth_m / by_pressure_m;
  if (times < kMinTimes || times > kMaxTimes) return {};
  return fmt::format("it is {:.6g} m where the pressure of {} is that of {:.3g} m: is it in cm or mm?", depth_m,
                     by_pressure.name, by_pressure_m);
}

/// Where a depth changes with the pressure, but up or by another factor than 1; or does not change, and is another one
/// by a usual factor.
void compare_with_pressure(NavSource& depth, const NavSource& by_pressure) {
  constexpr double kMin_m = 3.0, kApart_m = 2.0, kZeros_m = kSurface_pa / kPascalsPerMetre, kNear_m = 1.5;
  const Pairs pairs = numbers_together(depth, by_pressure);
  if (const std::optional<double> slope = slope_of(pairs)) {
    const double times = 1.0 / *slope;
    if (times < 0.0 && is_as_much(-times)) {
      depth.fault = fmt::format("it falls as the pressure of {} rises: does it point up?", by_pressure.name);
    } else if (!is_as_much(times)) {
      const std::string text =
          fmt::format("it changes {:.3g} times as much as that by the pressure of {}", times, by_pressure.name);
      (unit_of(times).empty() ? depth.doubt : depth.fault) = text + unit_question(times);
    }
    return;
  }
  if (pairs.empty()) return;
  const double depth_m = median_of(pairs, &Pairs::value_type::first);
  const double by_pressure_m = median_of(pairs, &Pairs::value_type::second);
  const double apart_m = std::fabs(depth_m - by_pressure_m);
  // Not that of the two zeros of a pressure.
  if (by_pressure_m < kMin_m || apart_m < kApart_m || std::fabs(apart_m - kZeros_m) < kNear_m) return;
  const double times = depth_m / by_pressure_m;
  if (unit_of(times).empty()) return;
  depth.doubt = fmt::format("it is {:.3g} m where the pressure of {} is that of {:.3g} m{}", depth_m, by_pressure.name,
                            by_pressure_m, unit_question(times));
}

/// Where a height goes up as a depth does, or by another factor, or is above the surface by what the depth is below.
std::string doubt_of_height(const NavSource& position, const NavSource& depth) {
  constexpr double kMin_m = 1.0, kNear = 0.1;
  NavSource height = position;
  for (NavSample& sample : height.samples) sample.value.x() = sample.value.z();
  const Pairs pairs = numbers_together(height, depth);
  const std::string other = fmt::format("the {} of {}", name_of(depth.quantity), depth.name);
  if (const std::optional<double> slope = slope_of(pairs)) {
    const double times = -1.0 / *slope;
    if (is_as_much(-times)) return fmt::format("its z grows as {} does: does it point down?", other);
    if (is_as_much(times)) return {};
    return fmt::format("its z changes {:.3g} times as much as {}{}", times, other, unit_question(std::fabs(times)));
  }
  if (pairs.empty()) return {};
  const double height_m = median_of(pairs, &Pairs::value_type::first);
  const double depth_m = median_of(pairs, &Pairs::value_type::second);
  if (depth_m < kMin_m || std::fabs(height_m - depth_m) > kNear * depth_m) return {};
  return fmt::format("its z is {:.3g} m above the origin where {} is {:.3g} m: does it point down?", height_m, other,
                     depth_m);
}

}  // namespace

std::string fault_of_depth(const NavSource& source) {
  constexpr double kFastest_m_s = 3.0, kAbove_m = 1.0;
  if (source.quantity != NavQuantity::kDepth) return {};
  const std::optional<NumberExtent> numbers = extent_of(source);
  if (!numbers) return {};
  if (numbers->speed_s > kFastest_m_s) {
    return fmt::format("it changes by {:.3g} m/s repeatedly, from {:.6g} to {:.6g} m: is it in cm or mm?",
                       numbers->speed_s, numbers->lowest, numbers->highest);
  }
  if (numbers->highest < -kAbove_m) {
    return fmt::format("it is {:.3g} m above the surface, or more, all the time: does it point up?", -numbers->highest);
  }
  return {};
}

void compare_depths(std::span<NavSource> sources) {
  const std::optional<NavSource> by_pressure = depth_by_pressure(sources);
  const NavSource* depth = by_pressure ? &*by_pressure : nullptr;
  for (NavSource& source : sources) {
    if (source.quantity != NavQuantity::kDepth || source.subject == NavSubject::kOther || !is_usable(source)) continue;
    if (by_pressure) source.fault = fault_by_pressure(source, *by_pressure);
    if (by_pressure && source.fault.empty()) compare_with_pressure(source, *by_pressure);
    if (source.fault.empty()) depth = &source;
  }
  if (depth == nullptr) return;
  for (NavSource& source : sources) {
    if (source.quantity != NavQuantity::kPosition || !is_usable(source) || source.subject == NavSubject::kOther) {
      continue;
    }
    if (std::string doubt = doubt_of_height(source, *depth); !doubt.empty()) source.doubt = std::move(doubt);
  }
}

}  // namespace pingvox
