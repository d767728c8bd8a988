#include "drives/drive.hpp"

#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "pingvox/geometry/pose2.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/nav.hpp"
#include "pingvox/nav/nav_trajectory.hpp"
#include "pingvox/sim/nav_sensors.hpp"
#include "pingvox/sim/sonar.hpp"
#include "pingvox/sim/vehicle.hpp"

namespace pingvox::bench {
namespace {

Result<NavLog> read_navigation(const std::filesystem::path& path) {
  const Result<FileBytes> file = read_file(path.string());
  if (!file) return tl::unexpected(file.error());
  Result<NavFile> nav = read_nav(*file);
  if (!nav) return tl::unexpected(nav.error());
  return std::move(nav->log);
}

}  // namespace

Result<Drive> simulate_drive(const Scene& scene, Motion motion, std::optional<std::size_t> turns, std::uint64_t seed) {
  SonarOptions sonar;
  sonar.seed = seed;
  sonar.beams_per_s = scene.beams_per_s;
  sonar.bin_length_m = scene.sonar_range_m / static_cast<double>(sonar.bins);
  const double turn_s = static_cast<double>(sonar.beams_per_turn) / sonar.beams_per_s;
  const TravelOptions travel;
  const Route& route = *scene.route(motion);
  const auto turns_in = [&](double duration_s) { return static_cast<std::size_t>(std::ceil(duration_s / turn_s)); };
  const std::size_t count = turns.value_or(turns_in(length_m(route) / travel.speed_m_s));
  const Trajectory way = motion == Motion::kByHand ? drive_by_hand(route, travel, seed)
                                                   : follow_route(route, static_cast<double>(count) * turn_s, travel);
  const double end_s = way.poses().back().time_s;

  SonarSimulator simulator(scene.world, way, sonar, motion == Motion::kByHand ? turns_in(end_s + turn_s) : count);
  std::vector<Beam> beams;
  for (;;) {
    Result<std::optional<Beam>> beam = simulator.next();
    if (!beam) return tl::unexpected(beam.error());
    if (!*beam) break;
    beams.push_back(*std::move(*beam));
  }
  NavSensorOptions sensors;
  sensors.seed = seed;
  sensors.delay_s = 0.0;
  SimulatedNav nav = simulate_nav(way, 0.0, end_s, sensors);
  return Drive{std::move(beams), std::move(nav.log), Pose::Identity(), way};
}

Result<Pose> align(const Trajectory& from, const Trajectory& onto) {
  std::vector<Eigen::Vector2d> these, those;
  for (const StampedPose& pose : from.poses()) {
    const auto there = onto.at(pose.time_s);
    if (!there) continue;
    these.emplace_back(pose.map_from_body.translation().head<2>());
    those.emplace_back(there->translation().head<2>());
  }
  if (these.size() < 2) return fail(Error::Code::kUnsupported, "the trajectories have no two times in common");
  const Pose2 fit = fit_pose2(these, those);
  return pose_from_rpy({fit.place_m.x(), fit.place_m.y(), 0.0}, 0.0, 0.0, fit.yaw_rad);
}

Trajectory move_by(const Pose& by, const Trajectory& trajectory) {
  std::vector<StampedPose> poses = trajectory.poses();
  for (StampedPose& pose : poses) pose.map_from_body = by * pose.map_from_body;
  return *Trajectory::make(std::move(poses));
}

Result<std::optional<Drive>> recorded_marina() {
  const std::filesystem::path folder = std::filesystem::path(PINGVOX_SHARED_DATA) / "marina-ribas-stpere";
  if (!std::filesystem::exists(folder / "is_hits.txt")) return std::nullopt;
  Result<FileBytes> hits = read_file((folder / "is_hits.txt").string());
  if (!hits) return tl::unexpected(hits.error());
  const Result<std::unique_ptr<BeamSource>> source = open_beams(*std::move(hits));
  if (!source) return tl::unexpected(source.error());
  Result<std::vector<Beam>> beams = read_all(**source);
  if (!beams) return tl::unexpected(beams.error());

  std::vector<NavSource> sources;
  for (const char* name : {"_040825_1735_DVL.log", "_040825_1735_MTI.log"}) {
    const Result<NavLog> log = read_navigation(folder / name);
    if (!log) return tl::unexpected(log.error());
    sources.insert(sources.end(), log->sources().begin(), log->sources().end());
  }
  Result<NavLog> nav = NavLog::make(std::move(sources), NavClock::kUnknown);
  if (!nav) return tl::unexpected(nav.error());
  const Result<NavLog> buoy = read_navigation(folder / "_040825_1735_DGPS.log");
  if (!buoy) return tl::unexpected(buoy.error());
  Result<NavTrajectory> fixes = nav_positions(*buoy);
  if (!fixes) return tl::unexpected(fixes.error());
  return Drive{*std::move(beams), *std::move(nav),
               pose_from_rpy(Eigen::Vector3d(0.33, 0.0, 0.26), 0.0, 0.0, std::numbers::pi),
               std::move(fixes->trajectory)};
}

}  // namespace pingvox::bench
