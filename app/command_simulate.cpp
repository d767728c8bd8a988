#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <ostream>
#include <system_error>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "io/internal/unknown_file.hpp"
#include "open_recording.hpp"
#include "option_values.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/io/mesh.hpp"
#include "pingvox/io/nav.hpp"
#include "pingvox/io/tum.hpp"
#include "recording_report.hpp"
#include "world_map.hpp"

namespace pingvox::app {
namespace {

/// Passes the beams of a simulator on and records the ground truth of each.
class TruthRecorder final : public BeamSource {
 public:
  struct Sent {
    double bearing_rad;  ///< as in the log
    SonarSimulator::Ping ping;
  };

  explicit TruthRecorder(SonarSimulator& simulator) : simulator_(simulator) {}

  Result<std::optional<Beam>> next() override {
    auto beam = simulator_.next();
    if (beam && *beam) sent_.push_back({(*beam)->bearing_rad, simulator_.ping()});
    return beam;
  }
  const std::vector<Sent>& sent() const { return sent_; }

 private:
  SonarSimulator& simulator_;
  std::vector<Sent> sent_;
};

Result<Scene> scene_of(const SimulateCommand& command) {
  if (command.world == "tank") return tank_scene(command.tank);
  if (command.world == "harbour") return harbour_scene({});
  if (command.world == "marina") return marina_scene({});
  if (command.world == "seabed") return seabed_scene({});
  if (command.world == "cave") return cave_scene({});
  const Result<FileBytes> file = read_file(command.world);
  if (!file) return tl::unexpected(file.error());
  Result<TriangleMesh> mesh = read_mesh(*file);
  if (!mesh) return tl::unexpected(mesh.error());
  Result<Scene> scene = mesh_scene(std::move(*mesh));
  if (!scene) return fail(Error::Code::kCorrupt, fmt::format("{}: {}", file->name, scene.error().message));
  return scene;
}

struct Journey {
  Trajectory way;
  std::size_t turns = 5;
};

Result<Journey> journey_of(const SimulateCommand& command, const Scene& scene, const SonarOptions& sonar) {
  constexpr std::size_t kMaxTurns = 10'000;
  const double turn_s = static_cast<double>(sonar.beams_per_turn) / sonar.beams_per_s;
  const auto turns_in = [&](double seconds) -> Result<std::size_t> {
    if (command.turns) return *command.turns;
    const double turns = std::max(1.0, std::ceil(seconds / turn_s));
    if (turns <= static_cast<double>(kMaxTurns)) return static_cast<std::size_t>(turns);
    return fail(
        Error::Code::kBadOption,
        fmt::format("simulate: the path takes {:.3g} turns of the head, more than {}: make it shorter or faster, or "
                    "give --turns",
                    turns, kMaxTurns));
  };
  if (command.poses) {
    Result<Trajectory> way = trajectory_of(command.poses);
    if (!way) return tl::unexpected(way.error());
    const double duration = way->poses().back().time_s - way->poses().front().time_s;
    // A beam is sent at the last pose, too.
    return turns_in(duration + turn_s).map([&](std::size_t turns) { return Journey{*std::move(way), turns}; });
  }
  const Route* route = scene.route(command.motion);
  if (!route) return Journey{Trajectory::still(Pose::Identity()), command.turns.value_or(5)};
  const double least_s = length_m(*route) / command.travel.speed_m_s;
  const Result<std::size_t> turns = turns_in(least_s);
  if (!turns) return tl::unexpected(turns.error());
  // By hand the whole route is driven, whatever the turns.
  const double duration = command.motion == Motion::kByHand ? least_s : static_cast<double>(*turns) * turn_s;
  constexpr double kMaxPoses = 1e6;
  if (duration / command.travel.pose_every_s > kMaxPoses) {
    return fail(Error::Code::kBadOption,
                fmt::format("simulate: the path takes {:.0f} s, longer than a built-in one: {:.0f} s", duration,
                            kMaxPoses * command.travel.pose_every_s));
  }
  if (command.motion == Motion::kByHand) {
    Trajectory way = drive_by_hand(*route, command.travel, sonar.seed);
    const double until_s = way.poses().back().time_s + turn_s;
    return turns_in(until_s).map([&](std::size_t to_its_end) { return Journey{std::move(way), to_its_end}; });
  }
  return Journey{follow_route(*route, duration, command.travel), *turns};
}

Result<void> write_trajectory(const std::string& path, const Trajectory& trajectory) {
  return write_file(path, [&](std::ostream& out) { return write_tum(trajectory, out); });
}

std::string text_of(const std::optional<double>& value) {
  return value ? fmt::format("{:.6f}", *value) : std::string();
}

Result<void> write_ranges(const std::string& path, const SonarSimulator& simulator,
                          const std::vector<TruthRecorder::Sent>& sent, const SonarOptions& sonar) {
  return write_file(path, [&](std::ostream& out) -> Result<void> {
    out << kTrueRangesHeader << '\n';
    for (const auto& [bearing_rad, ping] : sent) {
      const TrueRange range = true_range(simulator.world(), ping.map_from_sensor, ping.bearing_rad, sonar);
      out << fmt::format("{},{},{},{},{}\n", ping.time_s, bearing_rad, ping.bearing_rad, text_of(range.axis_m),
                         text_of(range.cone_m));
    }
    if (!out.flush()) return fail(Error::Code::kIo, fmt::format("{}: could not be written", path));
    return {};
  });
}

Result<OccupancyMap> true_map(const Scene& scene, const Trajectory& way, double resolution_m) {
  // The water includes the vehicle, even outside of the box of a mesh.
  Eigen::AlignedBox3d water = scene.water_m;
  for (const StampedPose& pose : way.poses()) water.extend(pose.map_from_body.translation());
  return world_map(scene.world, water, way.poses().front().map_from_body.translation(), resolution_m);
}

/// Navigation measurements while the sonar is on.
Result<SimulatedNav> navigation_of(const Journey& journey, const SonarOptions& sonar, const NavSensorOptions& sensors) {
  const std::vector<StampedPose>& poses = journey.way.poses();
  const double from_s = poses.front().time_s;
  const double sonar_s = static_cast<double>(journey.turns * sonar.beams_per_turn) / sonar.beams_per_s;
  const double duration_s = poses.size() > 1 ? std::min(sonar_s, poses.back().time_s - from_s) : sonar_s;
  constexpr double kMaxDuration_s = 1e5;
  if (duration_s > kMaxDuration_s) {
    return fail(Error::Code::kBadOption, fmt::format("simulate: --nav: {:.0f} s are longer than the longest, {:.0f} s",
                                                     duration_s, kMaxDuration_s));
  }
  return simulate_nav(journey.way, from_s, from_s + duration_s, sensors);
}

/// The errors that are constant, as what `slam` should find. The place of the wall in an echo is not an error.
SlamCalibration calibration_of(const NavSensorErrors& errors) {
  constexpr double kKnown_rad = 1e-4, kKnown = 1e-4, kKnown_m = 1e-3, kUnknown = 0.5;
  const auto angle = [](double value_rad) { return Estimate{value_rad, kKnown_rad}; };
  return {.velocity = "DVL",
          .velocity_yaw_rad = angle(errors.dvl_yaw_rad),
          .velocity_scale = {errors.dvl_scale, kKnown},
          .wall_in_echo = {0.0, kUnknown},
          .sonar_x_m = {0.0, kKnown_m},
          .sonar_y_m = {0.0, kKnown_m},
          .headings = {{.source = "IMU",
                        .constant_rad = angle(errors.constant_rad),
                        .sin1_rad = angle(errors.sin1_rad),
                        .cos1_rad = angle(errors.cos1_rad),
                        .sin2_rad = angle(errors.sin2_rad),
                        .cos2_rad = angle(errors.cos2_rad)}}};
}

Result<void> write_nav_errors(const std::string& path, const NavSensorErrors& errors, const NavSensorOptions& sensors) {
  return write_file(path, [&](std::ostream& out) -> Result<void> {
    out << fmt::format("# Errors of the simulated navigation.\n# nav-offset = {:.6g}\n", -sensors.delay_s)
        << fmt::format("# turn-rate-bias-start-deg-s = {:.6g}\n# turn-rate-bias-end-deg-s = {:.6g}\n",
                       errors.gyro_bias_start_rad_s / kDegree_rad, errors.gyro_bias_end_rad_s / kDegree_rad)
        << kCalibrationComment << calibration_toml({calibration_of(errors), {}});
    if (!out.flush()) return fail(Error::Code::kIo, fmt::format("{}: could not be written", path));
    return {};
  });
}

/// Of a vehicle that stands still: its pose at the first and at the last beam.
Result<Trajectory> true_poses(const Trajectory& way, const std::vector<TruthRecorder::Sent>& sent) {
  if (way.poses().size() > 1 || sent.size() < 2) return way;
  const Pose& pose = way.poses().front().map_from_body;
  return Trajectory::make({{sent.front().ping.time_s, pose}, {sent.back().ping.time_s, pose}});
}

Result<void> write_truth(const SimulateCommand& command, const OccupancyMap& map, double cell_m, const Trajectory& way,
                         const SonarSimulator& simulator, const TruthRecorder& recorder, const SonarOptions& sonar,
                         const std::optional<SimulatedNav>& nav) {
  const std::filesystem::path folder = *command.truth;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail(Error::Code::kIo, fmt::format("{}: {}", *command.truth, error.message()));
  const auto in_folder = [&folder](const char* name) { return (folder / name).string(); };

  const Result<Trajectory> poses = true_poses(way, recorder.sent());
  if (!poses) return tl::unexpected(poses.error());
  if (auto written = write_trajectory(in_folder("poses.tum"), *poses); !written) return written;
  if (auto written = write_ranges(in_folder("ranges.csv"), simulator, recorder.sent(), sonar); !written) return written;
  auto written = write_file(in_folder("world.ply"), [&](std::ostream& out) {
    return write_mesh_ply(simulator.world().mesh(0.1 * cell_m), out);
  });
  if (!written) return written;
  if (nav) {
    written = write_nav_errors(in_folder("nav.toml"), nav->errors, command.nav_sensors);
    if (!written) return written;
  }
  return write_map(map, in_folder("world.bt"));
}

}  // namespace

Result<int> run(const SimulateCommand& command, Console& console) {
  const Result<Scene> scene = scene_of(command);
  if (!scene) return tl::unexpected(scene.error());
  SonarOptions sonar = command.sonar;
  const double range = command.range_m.value_or(scene->sonar_range_m);
  sonar.beams_per_s = scene->beams_per_s;
  const double cell_m = command.truth_resolution_m.value_or(scene->cell_m);
  sonar.bin_length_m = command.bin_length_m.value_or(range / static_cast<double>(sonar.bins));
  if (sonar.bin_length_m > 1.0) {
    return fail(Error::Code::kBadOption,
                fmt::format("simulate: --bins: {} make bins of {:.6g} m of this world's {:.6g} m "
                            "of range, and 1 m is the longest: more of them, or a --range",
                            sonar.bins, sonar.bin_length_m, range));
  }
  if (const auto valid = sonar.validate(); !valid) return tl::unexpected(valid.error());
  const Result<Journey> journey = journey_of(command, *scene, sonar);
  if (!journey) return tl::unexpected(journey.error());

  // Steps that may fail come before the long ones.
  std::optional<OccupancyMap> map;
  if (command.truth) {
    Result<OccupancyMap> made = true_map(*scene, journey->way, cell_m);
    if (!made) return tl::unexpected(made.error());
    map = *std::move(made);
  }
  std::optional<SimulatedNav> nav;
  if (command.nav) {
    Result<SimulatedNav> made = navigation_of(*journey, sonar, command.nav_sensors);
    if (!made) return tl::unexpected(made.error());
    nav = *std::move(made);
  }

  SonarSimulator simulator(scene->world, journey->way, sonar, journey->turns);
  TruthRecorder recorder(simulator);
  BeamSource& source = command.truth ? static_cast<BeamSource&>(recorder) : simulator;
  std::size_t beams = 0;
  const Result<void> written = write_file(command.output, [&](std::ostream& out) -> Result<void> {
    const Result<std::size_t> count = write_csv(source, out);
    if (!count) return tl::unexpected(count.error());
    beams = *count;
    return {};
  });
  if (!written) return tl::unexpected(written.error());

  std::string summary = fmt::format("{}: {} beams of {}, {:.6g} m of range, seed {}\n", on_one_line(command.output),
                                    beams, on_one_line(command.world), sonar.range_m(), sonar.seed);
  if (journey->way.poses().size() > 1) {
    const std::string companion = std::filesystem::path(command.output).replace_extension(".tum").string();
    const auto reports = write_trajectory(companion, add_drift(journey->way, command.drift));
    if (!reports) return tl::unexpected(reports.error());
    summary += fmt::format("{}: {} reported poses\n", on_one_line(companion), journey->way.poses().size());
  }
  if (nav) {
    std::size_t samples = 0;
    const Result<void> done = write_file(*command.nav, [&](std::ostream& out) -> Result<void> {
      const Result<std::size_t> count = write_nav_csv(nav->log, out);
      if (!count) return tl::unexpected(count.error());
      samples = *count;
      return {};
    });
    if (!done) return tl::unexpected(done.error());
    summary += fmt::format("{}: {} samples of navigation\n", on_one_line(*command.nav), samples);
  }
  if (map) {
    const auto truth = write_truth(command, *map, cell_m, journey->way, simulator, recorder, sonar, nav);
    if (!truth) return tl::unexpected(truth.error());
    summary += fmt::format("{}: ground truth (poses.tum, ranges.csv, world.ply, world.bt{})\n",
                           on_one_line(*command.truth), nav ? ", nav.toml" : "");
  }
  const auto printed = console.summarise(summary, command.output);
  if (!printed) return tl::unexpected(printed.error());
  return 0;
}

}  // namespace pingvox::app
