#include "nav/internal/pressure_unit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>

#include "base/median.hpp"
#include "nav/number_extent.hpp"
#include "nav/plausible_values.hpp"
#include "nav/water_column.hpp"

namespace pingvox {
namespace {

/// One meaning of the numbers of a source.
struct Reading {
  std::string_view unit;
  double unit_pa = 1.0;
  bool is_gauge = false;  ///< 0 is the surface, not a vacuum

  double pascals(double number) const { return number * unit_pa + (is_gauge ? kSurface_pa : 0.0); }
  double depth_m(double number) const { return depth_of_pressure(pascals(number)); }
  std::string text() const { return fmt::format("{}{}", unit, is_gauge ? " above that of air" : ""); }
};

constexpr double kDbar_pa = 1e4, kPsi_pa = 6894.757, kMmHg_pa = 133.3224;

// Nobody builds a gauge in mmHg for water.
constexpr std::array kReadings = {
    Reading{"Pa", 1.0, false},        Reading{"hPa", 1e2, false},       Reading{"kPa", 1e3, false},
    Reading{"bar", 1e5, false},       Reading{"dbar", kDbar_pa, false}, Reading{"psi", kPsi_pa, false},
    Reading{"mmHg", kMmHg_pa, false}, Reading{"Pa", 1.0, true},         Reading{"hPa", 1e2, true},
    Reading{"kPa", 1e3, true},        Reading{"dbar", kDbar_pa, true},  Reading{"psi", kPsi_pa, true},
    Reading{"bar", 1e5, true}};

/// Air at sea level in any weather, and at the height of most lakes.
bool begins_in_air(const Reading& reading, const NumberExtent& numbers) {
  constexpr double kLowest_pa = 80'000.0;
  const double lowest_pa = reading.pascals(numbers.lowest);
  return !reading.is_gauge && lowest_pa >= kLowest_pa && lowest_pa <= kMaxInAir_pa;
}

/// Whether the pressure of air tells the unit: what is air in a larger one is a dive by a gauge in dbar as well.
bool is_known_from_air(const Reading& reading, const NumberExtent& numbers) {
  constexpr double kLargest_pa = 1e3;
  return begins_in_air(reading, numbers) && reading.unit_pa <= kLargest_pa && reading.unit_pa != kMmHg_pa;
}

/// The units of few sensors, which count only where most vehicles go: else no kPa could be told from them.
bool is_rare(const Reading& reading) {
  return reading.unit_pa == kDbar_pa || reading.unit_pa == kPsi_pa || reading.unit_pa == kMmHg_pa;
}

/// Where a recording begins.
enum class Begin { kAtZeroOfGauge, kAnywhere };

/// Whether the numbers can have this meaning at all. A gauge is known by a dive and, unless it is in Pa or in a rare
/// unit, by its zero.
bool is_possible_reading(const Reading& reading, const NumberExtent& numbers, Begin begin) {
  constexpr double kDeepest_m = 1000.0, kDeepestOfRare_m = 100.0, kMinDive_m = 0.3, kWeather_m = 1.0,
                   kThinAir_pa = 50'000.0;
  const double lowest_m = reading.depth_m(numbers.lowest), highest_m = reading.depth_m(numbers.highest);
  if (highest_m > (is_rare(reading) ? kDeepestOfRare_m : kDeepest_m)) return false;
  if (reading.unit_pa == kMmHg_pa && highest_m < kMinDive_m) return false;
  if (!reading.is_gauge) {
    // Air that is so thin is that of aircraft and of high mountains: it stays as thin.
    const bool is_thin_air =
        reading.unit_pa == 1.0 && reading.pascals(numbers.lowest) >= kThinAir_pa && highest_m <= 0.0;
    return is_thin_air || begins_in_air(reading, numbers) || reading.pascals(numbers.lowest) > kMaxInAir_pa;
  }
  const bool may_begin_deep = begin == Begin::kAnywhere || reading.unit_pa == 1.0 || is_rare(reading);
  return highest_m >= kMinDive_m && lowest_m >= -kWeather_m && (may_begin_deep || lowest_m < kMinDive_m);
}

/// Leaves out what goes up and down faster than any vehicle. Where all readings do, that of air may stay.
void leave_out_too_fast(std::vector<Reading>& readings, const NumberExtent& numbers) {
  constexpr double kFastest_m_s = 1.5;
  const auto is_too_fast = [&](const Reading& reading) {
    return numbers.speed_s * reading.unit_pa / kPascalsPerMetre > kFastest_m_s;
  };
  const bool are_all = std::ranges::all_of(readings, is_too_fast);
  std::erase_if(readings, [&](const Reading& reading) {
    const bool may_stay = are_all && (reading.unit_pa == 1.0 || is_known_from_air(reading, numbers));
    return is_too_fast(reading) && !may_stay;
  });
}

/// The readings, each with how far it is off a known depth [m], the best one first; empty: the depth says nothing.
std::vector<std::pair<double, Reading>> readings_by_depth(const NavSource& source, const NavSource& depth) {
  constexpr std::size_t kMinPairs = 3;
  const auto pairs = numbers_together(source, depth);  // a number, and a depth at the same time
  std::vector<std::pair<double, Reading>> readings;
  if (pairs.size() < kMinPairs) return readings;
  for (const Reading& reading : kReadings) {
    std::vector<double> off_m;
    for (const auto& [number, depth_m] : pairs) off_m.push_back(std::fabs(reading.depth_m(number) - depth_m));
    readings.emplace_back(median(std::move(off_m)), reading);
  }
  std::ranges::sort(readings, {}, [](const auto& reading) { return reading.first; });
  return readings;
}

std::optional<Reading> reading_by_depth(const NavSource& source, const NavSource& depth) {
  // Weather, fresh water and the place of the sensor, beside the ten metres between the two zeros.
  constexpr double kMaxOff_m = 1.5, kTimes = 3.0, kApart_m = 1.0;
  const auto readings = readings_by_depth(source, depth);
  if (readings.empty() || readings[0].first > kMaxOff_m) return std::nullopt;
  const auto& [off_m, reading] = readings.front();
  // mmHg is too rare to make a better fit doubtful.
  const auto next = std::ranges::find_if(readings.begin() + 1, readings.end(),
                                         [](const auto& other) { return other.second.unit_pa != kMmHg_pa; });
  if (next->first < kTimes * off_m + kApart_m) return std::nullopt;
  return reading;
}

/// The possible meanings; one: it is that.
std::vector<Reading> readings_of(const NavSource& source, const NumberExtent& numbers, const NavSource* depth,
                                 PressureUnit unit) {
  const auto is_stated = [unit](const Reading& reading) {
    return unit == PressureUnit::kOpen || reading.unit_pa == 1.0;
  };
  if (depth != nullptr) {
    if (const auto reading = reading_by_depth(source, *depth); reading && is_stated(*reading)) return {*reading};
  }
  std::vector<Reading> possible;
  for (const Begin begin : {Begin::kAtZeroOfGauge, Begin::kAnywhere}) {
    std::ranges::copy_if(kReadings, std::back_inserter(possible), [&](const Reading& reading) {
      return is_stated(reading) && is_possible_reading(reading, numbers, begin);
    });
    leave_out_too_fast(possible, numbers);
    if (!possible.empty()) break;
  }
  for (const Reading& reading : possible) {
    if (is_known_from_air(reading, numbers)) return {reading};
  }
  const auto is_usual = [](const Reading& reading) { return reading.unit_pa == 1.0 && !reading.is_gauge; };
  const auto usual = std::ranges::find_if(possible, is_usual);
  if (usual != possible.end() && usual->pascals(numbers.lowest) > kMaxInAir_pa) return {*usual};
  return possible;
}

/// "its numbers, from 604 to 624, may be kPa (50.0 to 52.0 m deep) or ..."
std::string fault_of(const std::vector<Reading>& possible, const NumberExtent& numbers, PressureUnit unit) {
  const std::string range = fmt::format("its numbers, from {:.6g} to {:.6g},", numbers.lowest, numbers.highest);
  if (possible.empty()) {
    return range + " are no pressures of air or water in " +
           (unit == PressureUnit::kOpen ? "Pa, hPa, kPa, bar, dbar, psi or mmHg" : "Pa");
  }
  std::string text;
  for (const Reading& reading : possible) {
    text += fmt::format("{}{} ({:.1f} to {:.1f} m deep)", text.empty() ? "" : " or ", reading.text(),
                        reading.depth_m(numbers.lowest), reading.depth_m(numbers.highest));
  }
  return fmt::format("{} may be {}: ambiguous without a depth in the log or a stated unit", range, text);
}

}  // namespace

void tell_pressure(NavSource& source, const NavSource* depth, PressureUnit unit) {
  const std::optional<NumberExtent> numbers = extent_of(source);
  if (!numbers) return;
  const std::vector<Reading> possible = readings_of(source, *numbers, depth, unit);
  if (possible.size() != 1) {
    source.fault = fault_of(possible, *numbers, unit);
    return;
  }
  const Reading& reading = possible.front();
  if (reading.unit_pa == 1.0 && !reading.is_gauge) return;
  source.note = "read as " + reading.text();
  for (NavSample& sample : source.samples) {
    // Of a sensor that did not answer yet.
    if (!reading.is_gauge && !is_answer(sample)) sample.valid = false;
    sample.value.x() = reading.pascals(sample.value.x());
    sample.deviation.x() *= reading.unit_pa;
  }
}

void tell_pressures(std::vector<NavSource>& sources, std::span<const std::string> stated) {
  NavSource* depth = nullptr;
  const auto valid = [](const NavSource& source) { return std::ranges::count_if(source.samples, &NavSample::valid); };
  for (NavSource& source : sources) {
    if (source.quantity == NavQuantity::kDepth && (depth == nullptr || valid(source) > valid(*depth))) depth = &source;
  }
  NavSource ordered;
  if (depth != nullptr) {
    ordered = *depth;
    std::ranges::sort(ordered.samples, {}, &NavSample::time_s);
    check_values(ordered);
  }
  for (NavSource& source : sources) {
    if (source.quantity != NavQuantity::kPressure) continue;
    const bool is_stated = std::ranges::find(stated, source.name) != stated.end();
    tell_pressure(source, depth != nullptr && is_usable(ordered) ? &ordered : nullptr,
                  is_stated ? PressureUnit::kStated : PressureUnit::kOpen);
  }
}

}  // namespace pingvox
