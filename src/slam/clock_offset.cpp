#include "pingvox/slam/clock_offset.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "base/median.hpp"
#include "slam/navigation.hpp"
#include "slam/yaw_clock.hpp"

namespace pingvox {
namespace {

constexpr double kGrid_s = 0.05;    ///< of the yaw
constexpr double kCoarse_s = 0.25;  ///< of the offsets that are tried
constexpr std::size_t kMaxChanges = 2'000, kMinChanges = 8;
constexpr double kMaxLength_s = 2.0 * 86'400.0;
constexpr double kAny_s = std::numeric_limits<double>::infinity();

tl::unexpected<Error> cannot_tell(std::string why) {
  return fail(Error::Code::kUnsupported, std::move(why));
}

/// A yaw on an even grid of times, NaN within gaps.
class EvenYaw {
 public:
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
  double from_s_;
  std::vector<double> values_;
};

/// How well a yaw explains changes of yaw, by the offset between their clocks.
class Comparison {
 public:
  Comparison(const std::vector<YawChange>& changes, const EvenYaw& yaw) : changes_(changes), yaw_(yaw) {}

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
    return known < kMinChanges ? -kAny_s : gain / (deviation_rad * deviation_rad);
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

 private:
  const std::vector<YawChange>& changes_;
  const EvenYaw& yaw_;
};

/// Gains of evenly spaced offsets.
struct Scan {
  double from_s, step_s;
  std::vector<double> gains;

  Scan(const Comparison& comparison, double from, double to, double step, double deviation_rad)
      : from_s(from), step_s(step) {
    const auto count = static_cast<std::size_t>(std::max(0.0, (to - from) / step)) + 1;
    for (std::size_t i = 0; i < count; ++i) gains.push_back(comparison.gain(offset_s(i), deviation_rad));
  }

  double offset_s(std::size_t i) const { return from_s + static_cast<double>(i) * step_s; }
  std::size_t best() const { return static_cast<std::size_t>(std::ranges::max_element(gains) - gains.begin()); }

  /// The best one that is not on the slopes of the peak at `top`; 0 if that is all there is.
  double best_beside(std::size_t top) const {
    // The top of a broad peak is not smooth.
    constexpr double kTop = 0.8;
    const double least = kTop * gains[top];
    std::size_t low = top, high = top;
    while (low > 0 && gains[low] > least) --low;
    while (high + 1 < gains.size() && gains[high] > least) ++high;
    while (low > 0 && gains[low - 1] < gains[low]) --low;
    while (high + 1 < gains.size() && gains[high + 1] < gains[high]) ++high;
    double best = 0.0;
    for (std::size_t i = 0; i < gains.size(); ++i) {
      if (i < low || i > high) best = std::max(best, gains[i]);
    }
    return best;
  }
};

/// At most kMaxChanges, evenly chosen.
std::vector<YawChange> thin(const std::vector<YawChange>& changes) {
  const std::size_t step = (changes.size() + kMaxChanges - 1) / kMaxChanges;
  std::vector<YawChange> kept;
  for (std::size_t i = 0; i < changes.size(); i += step) kept.push_back(changes[i]);
  return kept;
}

/// @param most_s  offsets from -most_s to most_s are tried, as far as the two overlap then
Result<ClockOffset> clock_offset(const std::vector<YawChange>& all, const TimeSeries& yaw_rad, double most_s) {
  if (all.size() < kMinChanges) return cannot_tell("too few sweeps show the same surroundings clearly");
  const std::vector<YawChange> changes = thin(all);
  const auto [first, last] = std::ranges::minmax(changes, {}, &YawChange::from_s);
  const double from_s = first.from_s, to_s = last.to_s;
  if (yaw_rad.to_s() - yaw_rad.from_s() > kMaxLength_s || to_s - from_s > kMaxLength_s) {
    return cannot_tell("a recording lasts longer than two days");
  }
  const EvenYaw yaw(yaw_rad);
  const Comparison comparison(changes, yaw);

  // The scale of what is ordinary: first that of all changes, then that of what the best offset leaves of them.
  std::vector<double> sizes;
  double squares = 0.0;
  for (const YawChange& change : changes) {
    sizes.push_back(std::abs(change.by_rad));
    squares += change.by_rad * change.by_rad;
  }
  constexpr double kMin_rad = 1e-6;
  const double usual_rad = kMadToDeviation * median(std::move(sizes));
  double deviation_rad = usual_rad > kMin_rad ? usual_rad : std::sqrt(squares / static_cast<double>(changes.size()));
  if (!(deviation_rad > kMin_rad)) return cannot_tell("the vehicle does not turn");
  const double lowest_s = std::max(from_s - yaw.to_s(), -most_s), highest_s = std::min(to_s - yaw.from_s(), most_s);
  Scan scan(comparison, lowest_s, highest_s, kCoarse_s, deviation_rad);
  if (scan.gains[scan.best()] == -kAny_s) return cannot_tell("too little of the turning is in both recordings");
  if (!(scan.gains[scan.best()] > 0.0)) return cannot_tell("the heading does not turn as the picture does");
  deviation_rad = std::max(kMin_rad, kMadToDeviation * median(comparison.rests_rad(scan.offset_s(scan.best()))));
  scan = Scan(comparison, lowest_s, highest_s, kCoarse_s, deviation_rad);
  const std::size_t top = scan.best();
  const bool is_cut_off = (top == 0 && lowest_s == -most_s) || (top + 1 == scan.gains.size() && highest_s == most_s);
  if (is_cut_off) return cannot_tell("the best offset is the largest that was tried");

  // Five standard deviations from no turning, and from any other offset.
  constexpr double kSure = 25.0, kSecond = 0.75;
  const double gain = scan.gains[top], second = scan.best_beside(top);
  if (gain < kSure) return cannot_tell("the vehicle turns too little");
  if (gain - second < kSure || second > kSecond * gain) {
    return cannot_tell("several offsets explain the turning equally well");
  }
  ClockOffset found{scan.offset_s(top), 0.0, 0};
  constexpr int kSteps = 10;
  for (int i = 0; i < kSteps; ++i) {
    found.offset_s += std::clamp(comparison.step(found.offset_s, deviation_rad).step_s, -kCoarse_s, kCoarse_s);
  }
  found.changes = comparison.rests_rad(found.offset_s).size();
  // Where in a part of a sweep the vehicle turns may be the same each time: that error does not average out.
  std::vector<double> spreads_s;
  for (const YawChange& change : changes) spreads_s.push_back(change.spread_s);
  found.deviation_s = std::hypot(comparison.step(found.offset_s, deviation_rad).deviation_s,
                                 median(std::move(spreads_s)) / std::sqrt(12));
  constexpr double kMaxDeviation_s = 1.0;
  if (!(found.deviation_s <= kMaxDeviation_s)) return cannot_tell("the vehicle turns too evenly");
  return found;
}

}  // namespace

bool ClockOffset::is_apart() const {
  constexpr double kDeviations = 5.0, kLeast_s = 0.5;
  return std::abs(offset_s) > std::max(kLeast_s, kDeviations * deviation_s);
}

Result<std::vector<YawChange>> yaw_changes(const NavLog& log) {
  constexpr double kStep_s = 1.0;
  if (const auto checked = check_clocks(log, kHeadingQuantities); !checked) return tl::unexpected(checked.error());
  std::vector<YawChange> changes;
  const std::optional<HeadingSource> heading = best_heading(log, {});
  if (!heading || heading->yaw_rad.to_s() - heading->yaw_rad.from_s() > kMaxLength_s) return changes;
  const TimeSeries& yaw = heading->yaw_rad;
  // Counted: adding a step to a time that is damaged may leave it as it was.
  const auto steps = static_cast<int>((yaw.to_s() - yaw.from_s()) / kStep_s);
  for (int i = 0; i < steps; ++i) {
    const double from_s = yaw.from_s() + i * kStep_s;
    if (yaw.gap_s(from_s, from_s + kStep_s) > 0.0) continue;
    changes.push_back({from_s, from_s + kStep_s, yaw.at(from_s + kStep_s) - yaw.at(from_s), 0.0});
  }
  return changes;
}

Result<ClockOffset> clock_offset(const std::vector<YawChange>& all, const NavLog& log) {
  if (const auto checked = check_clocks(log, kHeadingQuantities); !checked) return tl::unexpected(checked.error());
  const std::optional<HeadingSource> heading = best_heading(log, {});
  if (!heading) return cannot_tell("the navigation has no valid heading or attitude");
  return clock_offset(all, heading->yaw_rad, kAny_s);
}

std::optional<ClockOffset> clock_error(const std::vector<YawChange>& changes, const TimeSeries& yaw_rad) {
  // A search over all of a long recording would take longer than to map it.
  constexpr std::array<double, 3> kMost_s = {20.0, 40.0, 600.0};
  std::optional<ClockOffset> found;
  for (const double most_s : kMost_s) {
    if (const Result<ClockOffset> wider = clock_offset(changes, yaw_rad, most_s)) {
      found = *wider;
      if (!found->is_apart()) break;
    } else if (found) {
      found->is_one_of_several = true;
    }
  }
  return found;
}

std::optional<ClockOffset> clock_error(const std::vector<YawChange>& changes, const Trajectory& trajectory) {
  std::vector<double> times_s, yaws_rad;
  for (const StampedPose& pose : trajectory.poses()) {
    times_s.push_back(pose.time_s);
    add_yaw(rpy_of(pose.map_from_body.rotation()).z(), yaws_rad);
  }
  return clock_error(changes, TimeSeries(std::move(times_s), std::move(yaws_rad)));
}

}  // namespace pingvox
