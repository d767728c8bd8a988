#include "pingvox/nav/clock_offset.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "base/median.hpp"
#include "nav/internal/navigation.hpp"
#include "nav/internal/yaw_clock.hpp"
#include "nav/yaw_comparison.hpp"
#include "pingvox/geometry/pose2.hpp"

namespace pingvox {
namespace {

constexpr double kCoarse_s = 0.25;  ///< of the offsets that are tried
constexpr std::size_t kMaxChanges = 2'000;
constexpr double kAny_s = std::numeric_limits<double>::infinity();

tl::unexpected<Error> cannot_tell(std::string why) {
  return fail(Error::Code::kUnsupported, std::move(why));
}

/// Gains of evenly spaced offsets.
struct Scan {
  double from_s, step_s;
  std::vector<double> gains;

  Scan(const YawComparison& comparison, double from, double to, double step, double deviation_rad)
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
  if (all.size() < YawComparison::kMinChanges) return cannot_tell("too few sweeps show the same surroundings clearly");
  const std::vector<YawChange> changes = thin(all);
  const auto [first, last] = std::ranges::minmax(changes, {}, &YawChange::from_s);
  const double from_s = first.from_s, to_s = last.to_s;
  if (yaw_rad.to_s() - yaw_rad.from_s() > EvenYaw::kMaxLength_s || to_s - from_s > EvenYaw::kMaxLength_s) {
    return cannot_tell("a recording lasts longer than two days");
  }
  const EvenYaw yaw(yaw_rad);
  const YawComparison comparison(changes, yaw);

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

  const double gain = scan.gains[top], second = scan.best_beside(top);
  if (gain < kSureGain) return cannot_tell("the vehicle turns too little");
  if (!stands_out(gain, second)) return cannot_tell("several offsets explain the turning equally well");
  ClockOffset found{comparison.refine(scan.offset_s(top), deviation_rad), 0.0, 0};
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
  constexpr double kDeviations = 5.0, kMin_s = 0.5;
  return std::abs(offset_s) > std::max(kMin_s, kDeviations * deviation_s);
}

Result<std::vector<YawChange>> yaw_changes(const NavLog& log) {
  constexpr double kStep_s = 1.0;
  if (const auto checked = check_sources(log, kHeadingQuantities); !checked) return tl::unexpected(checked.error());
  std::vector<YawChange> changes;
  const std::optional<HeadingSource> heading = best_heading(log, {});
  if (!heading || heading->yaw_rad.to_s() - heading->yaw_rad.from_s() > EvenYaw::kMaxLength_s) return changes;
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
  if (const auto checked = check_sources(log, kHeadingQuantities); !checked) return tl::unexpected(checked.error());
  const std::optional<HeadingSource> heading = best_heading(log, {});
  if (!heading) return cannot_tell("the navigation has no valid heading or attitude");
  return clock_offset(all, heading->yaw_rad, kAny_s);
}

std::optional<ClockOffset> clock_error(const std::vector<YawChange>& changes, const std::vector<TimeSpan>& pauses,
                                       const TimeSeries& yaw_rad) {
  if (const auto jump = clock_jump(thin(changes), pauses, yaw_rad)) return jump;
  // A search over all of a long recording would take longer than to map it.
  constexpr std::array<double, 3> kMax_s = {20.0, 40.0, 600.0};
  std::optional<ClockOffset> found;
  for (const double max_s : kMax_s) {
    if (const Result<ClockOffset> wider = clock_offset(changes, yaw_rad, max_s)) {
      found = *wider;
      if (!found->is_apart()) break;
    } else if (found) {
      found->is_one_of_several = true;
    }
  }
  return found;
}

std::optional<ClockOffset> clock_error(const std::vector<YawChange>& changes, const std::vector<TimeSpan>& pauses,
                                       const Trajectory& trajectory) {
  std::vector<double> times_s, yaws_rad;
  for (const StampedPose& pose : trajectory.poses()) {
    times_s.push_back(pose.time_s);
    add_yaw(yaw_of(pose.map_from_body), yaws_rad);
  }
  return clock_error(changes, pauses, TimeSeries(std::move(times_s), std::move(yaws_rad)));
}

}  // namespace pingvox
