#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "nav/internal/navigation.hpp"
#include "pingvox/nav/clock_offset.hpp"

/// How well a yaw explains how a sonar's picture turns.
namespace pingvox {

/// A yaw on an even grid of times, NaN within gaps.
class EvenYaw {
 public:
  static constexpr double kMaxLength_s = 2.0 * 86'400.0;

  /// REQUIRES a yaw that is no longer than kMaxLength_s.
  explicit EvenYaw(const TimeSeries& yaw) : from_s_(yaw.from_s()) {
    const auto count = static_cast<std::size_t>((yaw.to_s() - yaw.from_s()) / kGrid_s) + 1;
    values_.reserve(count);
    std::size_t next = 0;
    const auto& times_s = yaw.times_s();
    for (std::size_t i = 0; i < count; ++i) {
      const double time_s = from_s_ + static_cast<double>(i) * kGrid_s;
      while (next + 1 < times_s.size() && times_s[next + 1] <= time_s) ++next;
      const bool is_known = next + 1 == times_s.size() || yaw.gap_s(times_s[next], times_s[next + 1]) == 0.0;
      values_.push_back(is_known ? yaw.at(time_s) : std::numeric_limits<double>::quiet_NaN());
    }
  }

  double from_s() const { return from_s_; }
  double to_s() const { return from_s_ + static_cast<double>(values_.size() - 1) * kGrid_s; }
  /// NaN where it is not known.
  double at(double time_s) const {
    const double place = (time_s - from_s_) / kGrid_s;
    if (!(place >= 0.0 && place < static_cast<double>(values_.size() - 1))) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    const auto i = static_cast<std::size_t>(place);
    return values_[i] + (place - static_cast<double>(i)) * (values_[i + 1] - values_[i]);
  }

 private:
  static constexpr double kGrid_s = 0.05;

  double from_s_;
  std::vector<double> values_;
};

/// A gain (YawComparison) that is five standard deviations from no turning.
inline constexpr double kSureGain = 25.0;
/// Whether it is as far from that of another offset, which explains the turning less well.
inline bool stands_out(double gain, double other) {
  constexpr double kSecond = 0.75;
  return gain - other >= kSureGain && other <= kSecond * gain;
}

/// How well a yaw explains changes of yaw, by the offset between their clocks.
class YawComparison {
 public:
  /// Fewer changes are not enough.
  static constexpr std::size_t kMinChanges = 8;

  YawComparison(const std::vector<YawChange>& changes, const EvenYaw& yaw) : changes_(changes), yaw_(yaw) {}

  /// What the yaw leaves of a change; NaN where it is not known.
  double rest_rad(const YawChange& change, double offset_s) const {
    return change.by_rad - yaw_.at(change.to_s - offset_s) + yaw_.at(change.from_s - offset_s);
  }

  /// By how much the yaw makes the sum of squares smaller than a vehicle that does not turn would, each square at most
  /// that of three deviations; in squares of the deviation. -infinity where the yaw is known for too few changes.
  double gain(double offset_s, double deviation_rad) const {
    const double most = 9.0 * deviation_rad * deviation_rad;
    double gain = 0.0;
    std::size_t known = 0;
    for (const YawChange& change : changes_) {
      const double rest = rest_rad(change, offset_s);
      if (std::isnan(rest)) continue;
      ++known;
      gain += std::min(change.by_rad * change.by_rad, most) - std::min(rest * rest, most);
    }
    return known < kMinChanges ? -std::numeric_limits<double>::infinity() : gain / (deviation_rad * deviation_rad);
  }

  std::vector<double> rests_rad(double offset_s) const {
    std::vector<double> rests;
    for (const YawChange& change : changes_) {
      if (const double rest = rest_rad(change, offset_s); !std::isnan(rest)) rests.push_back(std::abs(rest));
    }
    return rests;
  }

  /// A step of least squares over the changes that the yaw explains.
  struct Step {
    double step_s = 0.0;
    double deviation_s = std::numeric_limits<double>::infinity();
  };
  Step step(double offset_s, double deviation_rad) const {
    constexpr double kHalf_s = 0.1;
    // What disturbs one part of a sweep, as the way of the vehicle does, disturbs the next ones too: twenty stretches
    // of time count as independent, not their parts.
    constexpr std::size_t kStretches = 20;
    std::array<double, kStretches> sums{};
    double information = 0.0, alone = 0.0;
    for (std::size_t i = 0; i < changes_.size(); ++i) {
      const double before = rest_rad(changes_[i], offset_s - kHalf_s),
                   after = rest_rad(changes_[i], offset_s + kHalf_s);
      if (std::isnan(before) || std::isnan(after) || std::abs(before + after) > 6.0 * deviation_rad) continue;
      const double slope = (after - before) / (2.0 * kHalf_s), rest = 0.5 * (before + after);
      information += slope * slope;
      alone += slope * slope * rest * rest;
      sums[i * kStretches / changes_.size()] += slope * rest;
    }
    if (!(information > 0.0)) return {};
    double sum = 0.0, together = 0.0;
    for (const double s : sums) sum += s;
    for (const double s : sums) together += std::pow(s - sum / kStretches, 2);
    return {-sum / information, std::sqrt(std::max(alone, together)) / information};
  }

  /// An offset [s] after ten steps, no longer than those between offsets that are tried.
  double refine(double offset_s, double deviation_rad) const {
    constexpr int kSteps = 10;
    constexpr double kMaxStep_s = 0.25;
    for (int i = 0; i < kSteps; ++i) {
      offset_s += std::clamp(step(offset_s, deviation_rad).step_s, -kMaxStep_s, kMaxStep_s);
    }
    return offset_s;
  }

 private:
  const std::vector<YawChange>& changes_;
  const EvenYaw& yaw_;
};

}  // namespace pingvox
