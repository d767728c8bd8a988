#include "slam/odometry/velocity_gaps.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "slam/odometry/sonar_odometry.hpp"

namespace pingvox {
namespace {

/// Sweeps before and after a gap that are matched, too: their neighbours lead to what is expected in it.
constexpr std::ptrdiff_t kSweepsAround = 6;
/// Least time between samples that are put into a gap, and the most samples in the time of a sweep.
constexpr double kMinStep_s = 0.25, kMaxSamplesOfSweep = 100.0;

struct VelocitySample {
  double time_s, ahead, left, density;
};

VelocitySample sample_of(const VelocitySource& velocity, double time_s) {
  return {time_s, velocity.ahead.at(time_s), velocity.left.at(time_s), velocity.density.at(time_s)};
}

/// Between samples, before the first one and after the last one.
std::vector<TimeSpan> gaps_within(const TimeSpan& span, const TimeSeries& series) {
  std::vector<TimeSpan> gaps = series.gaps(series.from_s(), series.to_s());
  gaps.push_back({span.from_s, series.from_s()});
  gaps.push_back({series.to_s(), span.to_s});
  return gaps;
}

/// The sweeps of a gap and some around it.
std::span<const SweepEchoes> sweeps_around(const TimeSpan& gap, std::span<const SweepEchoes> sweeps) {
  const auto first = std::ranges::upper_bound(sweeps, gap.from_s, {}, &SweepEchoes::to_s);
  const auto end = std::ranges::lower_bound(sweeps, gap.to_s, {}, &SweepEchoes::from_s);
  if (first >= end) return {};
  return {first - std::min(kSweepsAround, first - sweeps.begin()), end + std::min(kSweepsAround, sweeps.end() - end)};
}

/// Adds samples of what the sonar says between each match and the next.
void fill(const TimeSpan& gap, const VelocitySource& seen, double longest_s, double step_s,
          std::vector<VelocitySample>& samples, std::vector<TimeSpan>& filled) {
  // The first and the last sample go on to the ends.
  const std::vector<double>& matches_s = seen.ahead.times_s();
  for (std::size_t i = 1; i + 2 < matches_s.size(); ++i) {
    const double from_s = std::max(matches_s[i], gap.from_s), to_s = std::min(matches_s[i + 1], gap.to_s);
    if (matches_s[i + 1] - matches_s[i] > longest_s || to_s - from_s < kMinStep_s) continue;
    filled.push_back({from_s, to_s});
    const double steps = std::ceil((to_s - from_s) / step_s);
    for (double n = 0.5; n < steps; n += 1.0) samples.push_back(sample_of(seen, from_s + n / steps * (to_s - from_s)));
  }
}

}  // namespace

std::vector<TimeSpan> fill_velocity_gaps(std::span<const SweepEchoes> sweeps, const TimeSpan& span,
                                         const Pose2& velocity_from_sonar, const HeadingSource& heading,
                                         VelocitySource& velocity) {
  const double sweep_s = sweep_duration_s(sweeps);
  const double step_s = std::max({velocity.ahead.usual_step_s(), kMinStep_s, sweep_s / kMaxSamplesOfSweep});
  std::vector<VelocitySample> samples;
  std::vector<TimeSpan> filled;
  const TimeSpan known{std::max(span.from_s, heading.yaw_rad.from_s()), std::min(span.to_s, heading.yaw_rad.to_s())};
  for (const TimeSpan& gap : gaps_within(known, velocity.ahead)) {
    if (gap.to_s - gap.from_s <= sweep_s) continue;
    const SonarOdometry odometry = sonar_odometry(sweeps_around(gap, sweeps), velocity_from_sonar, &heading);
    if (!odometry.is_observable) continue;
    fill(gap, sonar_velocity(odometry.velocity), kMaxStep_sweeps * sweep_s, step_s, samples, filled);
  }
  if (samples.empty()) return filled;
  for (const double time_s : velocity.ahead.times_s()) samples.push_back(sample_of(velocity, time_s));
  std::ranges::sort(samples, {}, &VelocitySample::time_s);
  std::vector<double> times_s, ahead, left, density;
  for (const VelocitySample& sample : samples) {
    times_s.push_back(sample.time_s);
    ahead.push_back(sample.ahead);
    left.push_back(sample.left);
    density.push_back(sample.density);
  }
  velocity.ahead = TimeSeries(times_s, std::move(ahead));
  velocity.left = TimeSeries(times_s, std::move(left));
  velocity.density = TimeSeries(std::move(times_s), std::move(density));
  return filled;
}

}  // namespace pingvox
