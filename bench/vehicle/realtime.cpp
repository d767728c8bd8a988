#include "realtime.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "bench/paired_timing.hpp"
#include "bench/tank_beams.hpp"
#include "pingvox/analysis/compare.hpp"
#include "pingvox/mapping/beam_mapper.hpp"
#include "pingvox/mapping/build_map.hpp"

namespace pingvox::bench {
namespace {

constexpr double kCell_m = 0.05;
constexpr double kTankRate_hz = 23.0, kFastRate_hz = 100.0;  ///< beams per second of the recording and of a fast head
constexpr int kReplays = 5;

/// Each beam updates the map at once.
BuildOptions vehicle_options() {
  BuildOptions options;
  options.filter = default_filter(Detector::kRise);
  options.model.shape = BeamShape::kCone;
  options.vote = Vote::kPerBeam;
  options.timing = Timing::kByBeam;
  return options;
}

struct Replay {
  std::vector<double> wall_s, cpu_s;  ///< by beam
  double whole_cpu_s = 0.0;
};

/// Cost of reading the CPU clock: a tenth to half of the time of a beam.
double cpu_of_asking_s() {
  std::vector<double> times;
  for (int i = 0; i < 1000; ++i) {
    const double before = cpu_time_s();
    times.push_back(cpu_time_s() - before);
  }
  return median(times);
}

/// Maps the beams one by one without waiting, by wall time.
Replay replay(const std::vector<Beam>& beams, BeamMapper& live) {
  Replay replay;
  std::vector<Beam> fresh = beams;
  const double cpu_before_s = cpu_time_s();
  for (Beam& beam : fresh) {
    const auto before = std::chrono::steady_clock::now();
    (void)live.add(std::move(beam), Pose::Identity());
    replay.wall_s.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count());
  }
  (void)live.finish();
  replay.whole_cpu_s = cpu_time_s() - cpu_before_s;
  return replay;
}

/// CPU times, in a separate replay so that reading that clock does not affect the wall times.
void add_cpu_times(const std::vector<Beam>& beams, Replay& replay) {
  OccupancyMap map({.resolution_m = kCell_m});
  BeamMapper live = *BeamMapper::make(vehicle_options(), map);
  std::vector<Beam> fresh = beams;
  const double asking_s = cpu_of_asking_s();
  for (Beam& beam : fresh) {
    const double before = cpu_time_s();
    (void)live.add(std::move(beam), Pose::Identity());
    replay.cpu_s.push_back(std::max(0.0, cpu_time_s() - before - asking_s));
  }
}

/// Checks that build_map by sweep knows the same cells. Its order of beams differs, so clamped values may differ.
Result<double> share_of_other_classes(const std::vector<Beam>& beams, const OccupancyMap& live_map) {
  OccupancyMap map({.resolution_m = kCell_m});
  BeamsInMemory source(beams);
  BuildOptions options = vehicle_options();
  options.timing = Timing::kBySweep;
  const auto report = build_map(source, Trajectory::still(Pose::Identity()), options, map);
  if (!report) return tl::unexpected(report.error());
  const auto found = compare_maps(live_map, map, Sameness::kOccupancy);
  if (!found) return tl::unexpected(found.error());
  if (found->cells() == 0 || found->only_a + found->only_b > 0) {
    return fail(Error::Code::kCorrupt,
                fmt::format("of {} cells {} are known in one map only", found->cells(), found->only_a + found->only_b));
  }
  return static_cast<double>(found->different) / static_cast<double>(found->cells());
}

/// Median of each beam over the replays, to suppress other load.
std::vector<double> medians_by_beam(const std::vector<Replay>& replays, std::vector<double> Replay::* times) {
  std::vector<double> medians;
  for (std::size_t i = 0; i < (replays.front().*times).size(); ++i) {
    std::vector<double> of_beam;
    for (const Replay& replay : replays) of_beam.push_back((replay.*times)[i]);
    medians.push_back(median(std::move(of_beam)));
  }
  return medians;
}

}  // namespace

Result<std::vector<Row>> realtime(const BenchOptions&) {
  const Result<TankBeams> tank = tank_beams();
  if (!tank) return tl::unexpected(tank.error());
  if (tank->beams.empty()) return fail(Error::Code::kCorrupt, "no beams to replay");
  std::vector<Replay> replays;
  std::optional<double> other;
  for (int i = 0; i < kReplays; ++i) {
    OccupancyMap map({.resolution_m = kCell_m});
    BeamMapper live = *BeamMapper::make(vehicle_options(), map);
    replays.push_back(replay(tank->beams, live));
    if (const std::size_t mapped = live.report().beams; mapped != tank->beams.size()) {
      return fail(Error::Code::kCorrupt, fmt::format("{} of {} beams came out", mapped, tank->beams.size()));
    }
    add_cpu_times(tank->beams, replays.back());
    if (other) continue;
    const auto share = share_of_other_classes(tank->beams, map);
    if (!share) return tl::unexpected(share.error());
    other = *share;
  }
  const std::vector<double> wall_s = medians_by_beam(replays, &Replay::wall_s);
  const std::vector<double> cpu_s = medians_by_beam(replays, &Replay::cpu_s);
  std::vector<double> whole_cpu_s;
  for (const Replay& replay : replays) whole_cpu_s.push_back(replay.whole_cpu_s);
  const double cpu_of_beam_s = median(whole_cpu_s) / static_cast<double>(tank->beams.size());
  Row row;
  row.add("name", "realtime")
      .add_truth("checked", true)
      .add("beams", std::uint64_t{tank->beams.size()})
      .add("p50_ms", 1e3 * percentile(wall_s, 0.5))
      .add("p99_ms", 1e3 * percentile(wall_s, 0.99))
      .add("max_ms", 1e3 * percentile(wall_s, 1.0))
      .add("cpu_p50_ms", 1e3 * percentile(cpu_s, 0.5))
      .add("cpu_p99_ms", 1e3 * percentile(cpu_s, 0.99))
      .add("cpu_max_ms", 1e3 * percentile(cpu_s, 1.0))
      .add("cpu_share", cpu_of_beam_s * kTankRate_hz)
      .add("cpu_share_at_100_hz", cpu_of_beam_s * kFastRate_hz)
      .add("input", tank->input)
      .add("share_of_other_classes", *other);
  return std::vector{row};
}

}  // namespace pingvox::bench
