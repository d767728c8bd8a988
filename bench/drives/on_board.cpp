#include "drives/on_board.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <thread>
#include <utility>

#include "drives/drive.hpp"
#include "live/live_slam.hpp"
#include "paired_timing.hpp"
#include "pingvox/nav/trajectory_score.hpp"
#include "pingvox/slam/causal_replay.hpp"

namespace pingvox::bench {
namespace {

constexpr double kSpeed = 20.0, kCell_m = 0.2;

/// Time of the recording, kSpeed times as fast as that of the machine.
class FastClock {
 public:
  explicit FastClock(double from_s) : from_s_(from_s) {}
  double now_s() const { return from_s_ + kSpeed * seconds(Clock::now() - start_); }
  void wait_until(double time_s) const {
    std::this_thread::sleep_until(start_ + std::chrono::duration_cast<Clock::duration>(
                                               std::chrono::duration<double>((time_s - from_s_) / kSpeed)));
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double seconds(Clock::duration time) { return std::chrono::duration<double>(time).count(); }

  double from_s_;
  Clock::time_point start_ = Clock::now();
};

struct Run {
  std::size_t late = 0;   ///< beams that were mapped later than a second of the recording after they were due
  double latest_s = 0.0;  ///< the latest one, in seconds of the machine
  double processor_s = 0.0;
};

/// Pushes all of a drive, each sample and beam at its time.
Result<Run> push(const Drive& drive, LiveSlam& slam) {
  Run run;
  const std::vector<NavSource>& sources = drive.nav.sources();
  std::vector<std::size_t> next(sources.size(), 0);
  const auto say_until = [&](double now_s) {
    for (std::size_t s = 0; s < sources.size(); ++s) {
      const NavSource& source = sources[s];
      for (; next[s] < source.samples.size() && source.samples[next[s]].time_s <= now_s; ++next[s]) {
        slam.add(s, source.name, source.quantity, source.samples[next[s]]);
      }
    }
  };
  const FastClock clock(drive.beams.front().time_s);
  const double processor_s = cpu_time_s();
  for (const Beam& beam : drive.beams) {
    clock.wait_until(beam.time_s);
    for (;;) {
      say_until(clock.now_s());
      if (const auto updated = slam.update(clock.now_s()); !updated) return tl::unexpected(updated.error());
      if (!slam.may_come(beam.time_s, clock.now_s())) break;
      std::this_thread::sleep_for(std::chrono::microseconds(500));
    }
    if (const auto added = slam.add(beam, clock.now_s()); !added) return tl::unexpected(added.error());
    // It may have waited for its samples.
    const double late_s = clock.now_s() - beam.time_s - 1.0;
    if (late_s > 1.0) ++run.late;
    run.latest_s = std::max(run.latest_s, late_s / kSpeed);
  }
  say_until(clock.now_s() + 10.0);
  run.processor_s = cpu_time_s() - processor_s;
  while (slam.status().is_correcting) {
    if (const auto updated = slam.update(clock.now_s()); !updated) return tl::unexpected(updated.error());
  }
  return run;
}

Result<SlamSolution> solve_causal(const Drive& drive, const SlamOptions& options) {
  CausalReplay slam(options);
  if (const auto added = slam.add(drive.nav); !added) return tl::unexpected(added.error());
  for (const Beam& beam : drive.beams) slam.add(beam);
  return slam.solve();
}

}  // namespace

Result<std::vector<Row>> slam_on_board(const BenchOptions& options) {
  const Result<std::optional<Drive>> recorded = recorded_marina();
  if (!recorded) return tl::unexpected(recorded.error());
  if (!*recorded) return fail(Error::Code::kUnsupported, "the recorded marina is not in ../shared/data");
  Drive drive = **recorded;
  // On board the motion is decided in the first seconds, and this navigation begins three minutes after the sonar.
  double nav_from_s = drive.beams.front().time_s;
  for (const NavSource& source : drive.nav.sources()) {
    if (!source.samples.empty()) nav_from_s = std::max(nav_from_s, source.samples.front().time_s);
  }
  std::erase_if(drive.beams, [&](const Beam& beam) { return beam.time_s < nav_from_s; });
  BuildOptions build;
  build.body_from_sensor = drive.body_from_sonar;
  Result<LiveSlam> slam = LiveSlam::make({}, 1, build, {.resolution_m = kCell_m});
  if (!slam) return tl::unexpected(slam.error());
  const double recorded_s = drive.beams.back().time_s - drive.beams.front().time_s;
  if (options.say != nullptr) options.say(fmt::format("  {:.0f} s at {} times their speed", recorded_s, kSpeed));
  const Result<Run> run = push(drive, *slam);
  if (!run) return tl::unexpected(run.error());
  const LiveSlamStatus status = slam->status();
  if (const auto finished = slam->finish(); !finished) return tl::unexpected(finished.error());

  if (options.say != nullptr) options.say("  slam --causal");
  SlamOptions causal_options;
  causal_options.body_from_sonar = drive.body_from_sonar;
  const Result<SlamSolution> causal = solve_causal(drive, causal_options);
  if (!causal) return tl::unexpected(causal.error());
  const auto score = [&](const Trajectory& path) { return score_trajectory(path, drive.reference); };
  const auto told = score(slam->solution()->trajectory), path = score(*slam->path()),
             replayed = score(causal->trajectory);
  if (!told) return tl::unexpected(told.error());
  if (!path) return tl::unexpected(path.error());
  if (!replayed) return tl::unexpected(replayed.error());
  const double beams_per_s = static_cast<double>(drive.beams.size()) / recorded_s;
  Row row;
  row.add("name", "slam-on-board")
      .add("drive", "recorded")
      .add("told_se2_m", told->se2.mean_m)
      .add("path_se2_m", path->se2.mean_m)
      .add("causal_se2_m", replayed->se2.mean_m)
      .add("corrections", std::uint64_t{status.corrections})
      .add("loops", std::uint64_t{status.loops})
      .add("late_beams", std::uint64_t{run->late})
      .add("latest_s", run->latest_s)
      .add("beams_per_s", beams_per_s)
      .add("share_of_core", run->processor_s / recorded_s);
  return std::vector<Row>{std::move(row)};
}

}  // namespace pingvox::bench
