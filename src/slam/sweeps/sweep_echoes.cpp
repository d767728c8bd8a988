#include "slam/sweeps/sweep_echoes.hpp"

#include <utility>

#include "base/median.hpp"
#include "slam/sweeps/level_head.hpp"
#include "slam/sweeps/reach.hpp"

namespace pingvox {

SweepEchoes sweep_echoes(const Sweep& sweep, const SlamOptions& options) {
  SweepEchoes heard{sweep.extent, sweep.beams.front().time_s, sweep.beams.back().time_s,
                    echo_runs(sweep, options.filter, options.echo)};
  const double sense = is_upside_down(options.body_from_sonar) ? -1.0 : 1.0;
  for (EchoRun& run : heard.runs) {
    run.bearing_rad *= sense;
    run.range_m *= options.sound_speed_ratio;
    run.half_length_m *= options.sound_speed_ratio;
  }
  return heard;
}

double sweep_duration_s(std::span<const SweepEchoes> sweeps) {
  std::vector<double> complete_s, all_s;
  for (const SweepEchoes& sweep : sweeps) {
    const double duration_s = sweep.to_s - sweep.from_s;
    if (sweep.extent != Sweep::Extent::kCut) complete_s.push_back(duration_s);
    all_s.push_back(duration_s);
  }
  return median(complete_s.empty() ? std::move(all_s) : std::move(complete_s));
}

double reach_of(std::span<const SweepEchoes> sweeps) {
  std::vector<double> ranges_m;
  for (const SweepEchoes& sweep : sweeps) {
    for (const EchoRun& run : sweep.runs) ranges_m.push_back(run.range_m);
  }
  return reach_of(std::move(ranges_m));
}

}  // namespace pingvox
