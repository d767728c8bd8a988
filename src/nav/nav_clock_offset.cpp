#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "nav/internal/navigation.hpp"
#include "pingvox/nav/clock_offset.hpp"

namespace pingvox {
namespace {

/// How two headings of one vehicle differ, by the offset between their clocks: whole curves, so that short and quick
/// turns count, which a change in a second at a time shows only in part.
class HeadingDifference {
 public:
  /// @param a  the offset is added to the times of `b` to get its times
  HeadingDifference(const TimeSeries& a, const TimeSeries& b) : b_(b) {
    const std::size_t step = a.size() / kMaxTimes + 1;
    for (std::size_t i = 0; i < a.size(); i += step) {
      const double from_s = a.times_s()[i], to_s = from_s + kTurn_s;
      if (to_s > a.to_s()) break;
      if (a.gap_s(from_s, to_s) > 0.0) continue;
      turns_.push_back({from_s, a.at(to_s) - a.at(from_s)});
    }
  }

  /// Mean of what the turns within half a second differ by, whatever the headings are counted from. infinity where too
  /// few are in both.
  double mean_rad(double offset_s) const {
    double sum_rad = 0.0;
    std::size_t known = 0;
    for (const Turn& turn : turns_) {
      const double from_s = turn.from_s - offset_s, to_s = from_s + kTurn_s;
      if (b_.gap_s(from_s, to_s) > 0.0) continue;
      ++known;
      sum_rad += std::abs(turn.by_rad - b_.at(to_s) + b_.at(from_s));
    }
    return known < kMinTimes ? std::numeric_limits<double>::infinity() : sum_rad / static_cast<double>(known);
  }

  /// The offset with the smallest mean within a quarter of a second. REQUIRES one with a finite mean.
  double best_near(double offset_s) const {
    constexpr double kWidest_s = 0.25, kFinest_s = 0.0005;
    double best_rad = mean_rad(offset_s);
    for (double step_s = kWidest_s / 2.0; step_s > kFinest_s; step_s /= 2.0) {
      for (const double other_s : {offset_s - step_s, offset_s + step_s}) {
        if (const double other_rad = mean_rad(other_s); other_rad < best_rad) {
          best_rad = other_rad;
          offset_s = other_s;
        }
      }
    }
    return offset_s;
  }

 private:
  static constexpr double kTurn_s = 0.5;
  static constexpr std::size_t kMaxTimes = 10'000, kMinTimes = 20;

  struct Turn {
    double from_s, by_rad;
  };
  const TimeSeries& b_;
  std::vector<Turn> turns_;
};

/// The run that a log counts from: the heading is the same with its offset, and another one a second earlier or later.
std::optional<NavClockOffset> by_device(std::span<const DeviceRun> runs, const HeadingDifference& difference) {
  constexpr double kElsewhere_s = 1.0, kSame = 0.5;
  std::optional<NavClockOffset> best;
  double best_rad = std::numeric_limits<double>::infinity();
  for (const DeviceRun& run : runs) {
    const double mean_rad = difference.mean_rad(run.zero_s);
    const double other_rad =
        std::min(difference.mean_rad(run.zero_s - kElsewhere_s), difference.mean_rad(run.zero_s + kElsewhere_s));
    if (!std::isfinite(other_rad) || !(mean_rad < kSame * other_rad) || !(mean_rad < best_rad)) continue;
    best = NavClockOffset{run.zero_s, run.deviation_s, NavClockOffset::By::kDevice};
    best_rad = mean_rad;
  }
  return best;
}

}  // namespace

Result<NavClockOffset> nav_clock_offset(const NavLog& dated, std::span<const DeviceRun> runs,
                                        const NavLog& from_start) {
  // Checks the clocks of both.
  const Result<std::vector<YawChange>> changes = yaw_changes(dated);
  if (!changes) return tl::unexpected(changes.error());
  if (const auto right = check_sources(from_start, kHeadingQuantities); !right) return tl::unexpected(right.error());
  const std::optional<HeadingSource> heading = best_heading(dated, {}), other = best_heading(from_start, {});
  if (!heading || !other) {
    return fail(Error::Code::kUnsupported, "the navigation has no valid heading or attitude");
  }
  const HeadingDifference difference(heading->yaw_rad, other->yaw_rad);
  if (const auto found = by_device(runs, difference)) return *found;
  const Result<ClockOffset> found = clock_offset(*changes, from_start);
  if (!found) return tl::unexpected(found.error());
  const bool is_known = std::isfinite(difference.mean_rad(found->offset_s));
  return NavClockOffset{is_known ? difference.best_near(found->offset_s) : found->offset_s, found->deviation_s,
                        NavClockOffset::By::kTurns};
}

}  // namespace pingvox
