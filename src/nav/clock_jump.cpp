#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <iterator>
#include <optional>
#include <vector>

#include "base/median.hpp"
#include "nav/internal/yaw_clock.hpp"
#include "nav/yaw_comparison.hpp"

namespace pingvox {
namespace {

constexpr std::size_t kMaxPauses = 20;

/// Where a clock may have jumped.
struct Jump {
  double at_s;      ///< on the clock of the changes; of the yaw's clock what comes after the jump is at once
  double offset_s;  ///< of the yaw's clock from then on
  double resumes_s;
};

/// Those of the longest pauses, in order of time.
std::vector<Jump> possible_jumps(const std::vector<TimeSpan>& pauses, const TimeSeries& yaw_rad) {
  std::vector<Jump> jumps;
  for (const TimeSpan& gap : yaw_rad.gaps(yaw_rad.from_s(), yaw_rad.to_s())) {
    jumps.push_back({gap.from_s, yaw_rad.usual_step_s() - (gap.to_s - gap.from_s), gap.to_s});
  }
  for (const TimeSpan& pause : pauses) jumps.push_back({pause.to_s, pause.to_s - pause.from_s, pause.to_s});
  std::erase_if(jumps, [](const Jump& jump) { return std::abs(jump.offset_s) < kMinPause_s; });
  std::ranges::sort(jumps, std::ranges::greater(), [](const Jump& jump) { return std::abs(jump.offset_s); });
  if (jumps.size() > kMaxPauses) jumps.resize(kMaxPauses);
  std::ranges::sort(jumps, {}, &Jump::at_s);
  return jumps;
}

}  // namespace

std::optional<ClockOffset> clock_jump(const std::vector<YawChange>& changes, const std::vector<TimeSpan>& pauses,
                                      const TimeSeries& yaw_rad) {
  constexpr double kMin_rad = 1e-6, kMaxOff_s = 2.0;
  const std::vector<Jump> jumps = possible_jumps(pauses, yaw_rad);
  if (jumps.empty() || yaw_rad.to_s() - yaw_rad.from_s() > EvenYaw::kMaxLength_s) return std::nullopt;
  const EvenYaw yaw(yaw_rad);
  for (const Jump& jump : jumps) {
    std::vector<YawChange> after;
    std::ranges::copy_if(changes, std::back_inserter(after), [&](const YawChange& c) { return c.from_s >= jump.at_s; });
    const YawComparison comparison(after, yaw);
    const std::vector<double> rests_rad = comparison.rests_rad(jump.offset_s);
    if (rests_rad.size() < YawComparison::kMinChanges) continue;
    const double deviation_rad = std::max(kMin_rad, kMadToDeviation * median(rests_rad));
    const double gain = comparison.gain(jump.offset_s, deviation_rad), none = comparison.gain(0.0, deviation_rad);
    if (gain < kSureGain || !std::isfinite(none) || !stands_out(gain, none)) continue;
    ClockOffset found{comparison.refine(jump.offset_s, deviation_rad), 0.0, rests_rad.size()};
    found.deviation_s = comparison.step(found.offset_s, deviation_rad).deviation_s;
    if (!(std::abs(found.offset_s - jump.offset_s) < kMaxOff_s) || !found.is_apart()) continue;
    found.from_s = jump.resumes_s;
    return found;
  }
  return std::nullopt;
}

}  // namespace pingvox
