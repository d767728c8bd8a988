#include "drives/slam.hpp"

#include <fmt/core.h>

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drives/draw_drive.hpp"
#include "drives/drive.hpp"
#include "drives/drive_maps.hpp"
#include "paired_timing.hpp"
#include "pingvox/nav/trajectory_score.hpp"
#include "pingvox/slam/causal_replay.hpp"
#include "pingvox/slam/locate_recording.hpp"
#include "pingvox/slam/slam_smoother.hpp"

namespace pingvox::bench {
namespace {

struct Method {
  std::string_view name;
  Matching matching = Matching::kPairs;
  Estimation estimation = Estimation::kBatch;
};

template <class Slam>
Result<SlamSolution> solve_by(const Drive& drive, std::vector<Beam> beams, const SlamOptions& options) {
  Slam slam(options);
  if (const auto added = slam.add(drive.nav); !added) return tl::unexpected(added.error());
  for (Beam& beam : beams) slam.add(std::move(beam));
  return slam.solve();
}

constexpr Method kReckoning = {"dead reckoning", Matching::kNone, Estimation::kBatch};
constexpr Method kBatch = {"slam", Matching::kPairs, Estimation::kBatch};
constexpr Method kCausal = {"slam --causal", Matching::kPairs, Estimation::kCausal};

struct Solved {
  SlamSolution solution;
  double seconds;
};

Result<Solved> solve(const Drive& drive, const Method& method, std::uint64_t seed) {
  SlamOptions options;
  options.matching = method.matching;
  options.seed = seed;
  options.body_from_sonar = drive.body_from_sonar;
  std::vector<Beam> beams = drive.beams;
  const double before_s = cpu_time_s();
  Result<SlamSolution> solution = method.estimation == Estimation::kCausal
                                      ? solve_by<CausalReplay>(drive, std::move(beams), options)
                                      : solve_by<SlamSmoother>(drive, std::move(beams), options);
  if (!solution) return tl::unexpected(solution.error());
  return Solved{*std::move(solution), cpu_time_s() - before_s};
}

double length_m(const Trajectory& way) {
  double sum_m = 0.0;
  const std::vector<StampedPose>& poses = way.poses();
  for (std::size_t i = 1; i < poses.size(); ++i) {
    sum_m += (poses[i].map_from_body.translation() - poses[i - 1].map_from_body.translation()).head<2>().norm();
  }
  return sum_m;
}

/// The errors of a trajectory, in metres; `of_way` is the root of the mean square over the length of the way.
Result<Row> row_of(std::string_view drive, const Method& method, std::uint64_t seed, const Solved& solved,
                   const Trajectory& reference) {
  const Trajectory& found = solved.solution.trajectory;
  const Result<TrajectoryScore> score = score_trajectory(found, reference);
  if (!score) return tl::unexpected(score.error());
  const double way_m = length_m(found), recorded_s = found.poses().back().time_s - found.poses().front().time_s;
  Row row;
  row.add("name", "slam")
      .add("drive", drive)
      .add("method", method.name)
      .add("seed", seed)
      .add("way_m", way_m)
      .add("first_fix_m", score->first_fix.mean_m)
      .add("translation_m", score->translation.mean_m)
      .add("se2_m", score->se2.mean_m)
      .add("se2_rmse_m", score->se2.rmse_m)
      .add("se2_max_m", score->se2.max_m)
      .add("of_way", score->se2.rmse_m / way_m)
      .add("loops_kept", std::uint64_t{solved.solution.report.pairs.loops.kept})
      .add("seconds", solved.seconds)
      .add("times_real_time", recorded_s / solved.seconds);
  return row;
}

/// One drive by some methods; the first two of them are drawn.
class Measurement {
 public:
  Measurement(const BenchOptions& options, std::vector<Row>& rows) : options_(options), rows_(rows) {}

  Result<void> measure(std::string_view name, const Drive& drive, const Method& method, std::uint64_t seed,
                       std::span<const DriveMaps> maps = {}) {
    if (options_.say != nullptr) options_.say(fmt::format("  {}: {}, seed {}", name, method.name, seed));
    const Result<Solved> solved = solve(drive, method, seed);
    if (!solved) return tl::unexpected(solved.error());
    Result<Row> row = row_of(name, method, seed, *solved, drive.reference);
    if (!row) return tl::unexpected(row.error());
    rows_.push_back(*std::move(row));
    if (!maps.empty()) {
      Pose body_from_sonar = drive.body_from_sonar;
      if (method.matching == Matching::kPairs) {
        const SlamCalibration& found = solved->solution.calibration;
        body_from_sonar.pretranslate(Eigen::Vector3d(found.sonar_x_m.value, found.sonar_y_m.value, 0.0));
      }
      if (auto judged = judge(maps, method.name, solved->solution.trajectory, body_from_sonar); !judged) return judged;
    }
    if (!options_.pictures || drawn_.size() == 2) return {};
    drawn_.push_back({std::string(method.name), solved->solution.trajectory});
    if (drawn_.size() < 2) return {};
    return draw_drive(drive, drawn_, *options_.pictures, fmt::format("slam-{}.png", name));
  }
  void next_drive() { drawn_.clear(); }

  Result<void> judge(std::span<const DriveMaps> maps, std::string_view method, const Trajectory& trajectory,
                     const Pose& body_from_sonar) {
    for (const DriveMaps& of_cells : maps) {
      Result<std::vector<Row>> judged = of_cells.judge(method, trajectory, body_from_sonar);
      if (!judged) return tl::unexpected(judged.error());
      map_rows_.insert(map_rows_.end(), judged->begin(), judged->end());
    }
    return {};
  }
  const std::vector<Row>& map_rows() const { return map_rows_; }

 private:
  const BenchOptions& options_;
  std::vector<Row>& rows_;
  std::vector<Row> map_rows_;
  std::vector<MapPath> drawn_;
};

/// Dead reckoning and SLAM of a simulated drive, and the maps along both and along the true way, in cells of each size.
Result<void> measure_simulated(std::string_view name, const Scene& scene, const Drive& drive, std::uint64_t seed,
                               std::span<const double> cells_m, Measurement& measurement) {
  std::vector<DriveMaps> maps;
  for (const double cell_m : cells_m) {
    Result<DriveMaps> of_cells = DriveMaps::make(name, scene, drive, seed, cell_m);
    if (!of_cells) return tl::unexpected(of_cells.error());
    maps.push_back(*std::move(of_cells));
  }
  for (const Method& method : {kReckoning, kBatch}) {
    if (auto done = measurement.measure(name, drive, method, seed, maps); !done) return done;
  }
  return measurement.judge(maps, "true", drive.reference, drive.body_from_sonar);
}

}  // namespace

Result<std::vector<Row>> slam(const BenchOptions& options) {
  constexpr std::uint64_t kRecordedSeeds = 5, kSimulatedSeeds = 10;
  std::vector<Row> rows, rebuilt;
  Measurement measurement(options, rows);
  const Result<std::optional<Drive>> recorded = recorded_marina();
  if (!recorded) return tl::unexpected(recorded.error());
  if (*recorded) {
    const auto measure = [&](const Method& method, std::uint64_t seed) {
      return measurement.measure("recorded", **recorded, method, seed);
    };
    if (const auto done = measure(kReckoning, 1); !done) return tl::unexpected(done.error());
    for (std::uint64_t seed = 1; seed <= kRecordedSeeds; ++seed) {
      if (const auto done = measure(kBatch, seed); !done) return tl::unexpected(done.error());
    }
    if (const auto done = measure(kCausal, 1); !done) return tl::unexpected(done.error());
  }
  constexpr std::size_t kHarbourTurns = 50;  // two laps
  // In the marina also of a quarter of the width of a beam at the end of its range.
  constexpr std::array kMarinaCells_m = {0.2, 0.6};
  constexpr std::array kHarbourCells_m = {0.05};
  const Scene marina = marina_scene({}), harbour = harbour_scene({});
  const auto each_seed = [&](std::string_view name, const Scene& scene, Motion motion, std::optional<std::size_t> turns,
                             std::span<const double> cells_m) -> Result<void> {
    for (std::uint64_t seed = 1; seed <= kSimulatedSeeds; ++seed) {
      if (seed == 1) measurement.next_drive();
      const Result<Drive> drive = simulate_drive(scene, motion, turns, seed);
      if (!drive) return tl::unexpected(drive.error());
      if (auto done = measure_simulated(name, scene, *drive, seed, cells_m, measurement); !done) return done;
      if (seed > 1 || motion != Motion::kByHand) continue;
      for (const auto& [shape, cell_m] : {std::pair{BeamShape::kRay, 0.1}, {BeamShape::kCone, 0.2}}) {
        Result<Row> row = rebuild_map(name, *drive, shape, cell_m);
        if (!row) return tl::unexpected(row.error());
        rebuilt.push_back(*std::move(row));
      }
    }
    return {};
  };
  if (const auto done = each_seed("simulated", marina, Motion::kByHand, std::nullopt, kMarinaCells_m); !done) {
    return tl::unexpected(done.error());
  }
  if (const auto done = each_seed("harbour", harbour, Motion::kLoop, kHarbourTurns, kHarbourCells_m); !done) {
    return tl::unexpected(done.error());
  }
  rows.insert(rows.end(), measurement.map_rows().begin(), measurement.map_rows().end());
  rows.insert(rows.end(), rebuilt.begin(), rebuilt.end());
  return rows;
}

}  // namespace pingvox::bench
