#include "nav/number_extent.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>

namespace pingvox {
namespace {

/// The lowest and highest value, but for this share of them at either end.
std::pair<double, double> range_of(std::vector<double> values, double share) {
  const auto left_out = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::sort(values);
  return {values[left_out], values[values.size() - 1 - left_out]};
}

}  // namespace

bool is_answer(const NavSample& sample) {
  return sample.valid && sample.value.x() != 0.0;
}

std::optional<NumberExtent> extent_of(const NavSource& source) {
  constexpr double kOutliers = 0.01, kFastest = 0.1, kStep_s = 1.0;
  std::vector<double> values, speeds_s;
  const NavSample* before = nullptr;
  for (const NavSample& sample : source.samples) {
    if (!is_answer(sample)) continue;
    values.push_back(sample.value.x());
    const double step_s = before != nullptr ? sample.time_s - before->time_s : 0.0;
    if (before != nullptr && step_s < kStep_s) continue;
    if (before != nullptr) speeds_s.push_back(std::fabs(sample.value.x() - before->value.x()) / step_s);
    before = &sample;
  }
  if (values.empty()) return std::nullopt;
  NumberExtent numbers;
  std::tie(numbers.lowest, numbers.highest) = range_of(std::move(values), kOutliers);
  if (!speeds_s.empty()) numbers.speed_s = range_of(std::move(speeds_s), kFastest).second;
  return numbers;
}

std::vector<std::pair<double, double>> numbers_together(const NavSource& one, const NavSource& other) {
  constexpr double kNear_s = 1.0;
  constexpr std::size_t kEnough = 1000;
  const std::size_t step = std::max<std::size_t>(1, one.samples.size() / kEnough);
  std::vector<std::pair<double, double>> pairs;
  for (std::size_t i = 0; i < one.samples.size(); i += step) {
    const NavSample& sample = one.samples[i];
    if (!is_answer(sample)) continue;
    const auto near = std::ranges::lower_bound(other.samples, sample.time_s - kNear_s, {}, &NavSample::time_s);
    const auto until = std::ranges::upper_bound(other.samples, sample.time_s + kNear_s, {}, &NavSample::time_s);
    const auto distance_s = [&](const NavSample& its) {
      return its.valid ? std::fabs(its.time_s - sample.time_s) : 2.0 * kNear_s;
    };
    const auto nearest = std::ranges::min_element(near, until, {}, distance_s);
    if (nearest != until && nearest->valid) pairs.emplace_back(sample.value.x(), nearest->value.x());
  }
  return pairs;
}

}  // namespace pingvox
