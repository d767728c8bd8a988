#include "nav/depth_checks.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
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

/// Where a depth is a hundred or a thousand times that by the pressure.
std::string fault_by_pressure(const NavSource& depth, const NavSource& by_pressure) {
  constexpr std::size_t kFewest = 3;
  constexpr double kLeast_m = 1.0, kZeros_m = 15.0, kLeastTimes = 50.0, kMostTimes = 2000.0;
  const Pairs pairs = numbers_together(depth, by_pressure);
  if (pairs.size() < kFewest) return {};
  const double depth_m = median_of(pairs, &Pairs::value_type::first);
  const double by_pressure_m = median_of(pairs, &Pairs::value_type::second);
  // The zero of a pressure may be ten metres off, that of air.
  if (by_pressure_m < kLeast_m || std::fabs(depth_m - by_pressure_m) < kZeros_m) return {};
  const double times = depth_m / by_pressure_m;
  if (times < kLeastTimes || times > kMostTimes) return {};
  return fmt::format("it is {:.6g} m where the pressure of {} is that of {:.3g} m: is it in cm or mm?", depth_m,
                     by_pressure.name, by_pressure_m);
}

/// By how much the second numbers of pairs change where the first ones change by 1; nullopt: they do not change
/// together, or not enough to tell.
std::optional<double> slope_of(const Pairs& pairs) {
  constexpr std::size_t kFewest = 10;
  constexpr double kLeast_m = 0.08, kLeastCorrelation = 0.95;
  if (pairs.size() < kFewest) return std::nullopt;
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
  const bool is_enough = std::min(aa, bb) >= kLeast_m * kLeast_m;
  if (!is_enough || ab * ab < kLeastCorrelation * kLeastCorrelation * aa * bb) return std::nullopt;
  return ab / aa;
}

/// Where a height goes up as a depth does.
std::string doubt_of_height(const NavSource& position, const NavSource& depth) {
  constexpr double kLeast = 0.5, kMost = 2.0;
  NavSource height = position;
  for (NavSample& sample : height.samples) sample.value.x() = sample.value.z();
  const std::optional<double> slope = slope_of(numbers_together(height, depth));
  if (!slope || *slope < kLeast || *slope > kMost) return {};
  return fmt::format("its z grows as the {} of {} does: does it point down?", name_of(depth.quantity), depth.name);
}

}  // namespace

std::string fault_of_depth(const NavSource& source) {
  constexpr double kFastest_m_s = 3.0, kAbove_m = 1.0;
  if (source.quantity != NavQuantity::kDepth) return {};
  const std::optional<NumberExtent> numbers = extent_of(source);
  if (!numbers) return {};
  if (numbers->speed_s > kFastest_m_s) {
    return fmt::format("it changes by {:.3g} m/s again and again, from {:.6g} to {:.6g} m: is it in cm or mm?",
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
