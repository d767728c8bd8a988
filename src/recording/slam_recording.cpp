#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "base/median.hpp"
#include "io/internal/beams_in_order.hpp"
#include "pingvox/recording/recording.hpp"
#include "pingvox/slam/causal_replay.hpp"
#include "recording/move_trajectory.hpp"

namespace pingvox {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The files that a solution is made of: "dive.csv, nav.csv"
std::string names_of(const Recording& recording) {
  const std::string& log = recording.logs().front().name();
  std::string text = recording.logs().front().is_standard_input() ? std::string(ByteStream::kStandardInput) : log;
  for (const InputFile& nav : recording.options().nav) {
    if (nav.name() != log) text += ", " + nav.name();
  }
  return text;
}

SlamOptions options_for(const Recording& recording, SlamOptions options) {
  const RecordingOptions& of = recording.options();
  options.body_from_sonar = of.body_from_sonar;
  options.body_from_source = of.nav_mounts;
  options.nav_offset_s = recording.nav_offset()->offset_s;
  if (recording.water()) options.sound_speed_ratio = sound_speed_ratio(*recording.water());
  if (!of.calibration) return options;
  options.calibration = of.calibration->calibration;
  const auto& sources = recording.nav().log.sources();
  for (const auto& [source, pose] : of.calibration->body_from_source) {
    if (std::ranges::find(sources, source, &NavSource::name) != sources.end()) {
      options.body_from_source.emplace(source, pose);
    }
  }
  return options;
}

using Estimator = std::variant<SlamSmoother, CausalReplay>;

Estimator estimator_of(Estimation estimation, const SlamOptions& options) {
  if (estimation == Estimation::kCausal) return CausalReplay(options);
  return SlamSmoother(options);
}

/// Gives the estimator the beams of a log, and notes their times.
Result<void> add_beams(const Recording& recording, OpenedLog log, Estimator& estimator, RecordingSlam& slam,
                       std::vector<double>& times_s) {
  const std::string name = log.name;
  Result<std::unique_ptr<BeamSource>> source = only_beams(std::move(log.log), name);
  if (!source) return tl::unexpected(source.error());
  if (!recording.options().nav.empty()) {
    if (const auto has = check_has_times(**source, name); !has) return tl::unexpected(has.error());
  }
  const std::unique_ptr<BeamSource> beams = in_order(*std::move(source), name);
  for (;;) {
    Result<std::optional<Beam>> beam = beams->next();
    if (!beam) return tl::unexpected(beam.error());
    if (!*beam) break;
    times_s.push_back((*beam)->time_s);
    std::visit([&](auto& to) { to.add(std::move(**beam)); }, estimator);
  }
  slam.skipped += beams->skipped();
  if (const std::string note = beams->note(); !note.empty()) slam.notes.push_back({name, note});
  return {};
}

/// Moves the trajectory into the frame of the navigation, so that maps along both coincide: by the median offset to
/// positions, or the first pose of dead reckoning, whose errors accumulate.
void move_to_path(const Recording& recording, RecordingSlam& slam) {
  if (recording.options().nav.empty()) return;
  const Result<VehiclePath> path = recording.path();
  if (!path || !path->nav || path->axes != MapAxes::kEastNorth) return;
  std::vector<double> east_m, north_m, up_m;
  for (const StampedPose& pose : slam.solution.trajectory.poses()) {
    const std::optional<Pose> there = path->trajectory.at(pose.time_s);
    if (!there) continue;
    const Eigen::Vector3d apart_m = there->translation() - pose.map_from_body.translation();
    east_m.push_back(apart_m.x());
    north_m.push_back(apart_m.y());
    up_m.push_back(apart_m.z());
    if (path->nav->position.empty()) break;
  }
  if (east_m.empty()) return;
  const Eigen::Translation3d move(median(std::move(east_m)), median(std::move(north_m)), median(std::move(up_m)));
  Trajectory& trajectory = slam.solution.trajectory;
  trajectory = moved(trajectory, Pose(move));
  slam.frame_of = path->nav;
}

}  // namespace

VehiclePath RecordingSlam::path() const {
  VehiclePath path{.trajectory = solution.trajectory, .axes = MapAxes::kEastNorth};
  if (options.matching == Matching::kPairs) {
    path.sonar_moved_m = sonar_moved_by(solution.calibration);
  } else if (options.calibration) {
    path.sonar_moved_m = sonar_moved_by(*options.calibration);
  }
  return path;
}

Result<RecordingSlam> slam(const Recording& recording, const SlamOptions& options, Estimation estimation,
                           std::optional<OpenedLog> first) {
  if (!recording.nav_offset()) return tl::unexpected(recording.nav_offset().error());
  auto start = std::chrono::steady_clock::now();
  RecordingSlam slam{{Trajectory::still(Pose::Identity()), {}, {}, {}}, options_for(recording, options)};
  if (const auto valid = slam.options.validate(); !valid) return tl::unexpected(valid.error());
  Estimator estimator = estimator_of(estimation, slam.options);
  const Result<void> added = std::visit([&](auto& to) { return to.add(recording.nav().log); }, estimator);
  if (!added) {
    return fail(added.error().code, fmt::format("{}: {}", recording.nav_names(), added.error().message));
  }
  slam.skipped = recording.nav().damaged;
  std::vector<double> times_s;
  for (std::size_t i = 0; i < recording.logs().size(); ++i) {
    Result<OpenedLog> log = i == 0 && first ? *std::exchange(first, std::nullopt) : recording.open_log(i);
    if (!log) return tl::unexpected(log.error());
    if (const auto read = add_beams(recording, *std::move(log), estimator, slam, times_s); !read) {
      return tl::unexpected(read.error());
    }
  }
  slam.read_s = seconds_since(start);
  start = std::chrono::steady_clock::now();
  Result<SlamSolution> solution = std::visit([](const auto& of) { return of.solve(); }, estimator);
  if (!solution) {
    return fail(solution.error().code, fmt::format("{}: {}", names_of(recording), solution.error().message));
  }
  slam.solution = *std::move(solution);
  slam.beams = times_s.size();
  for (const double time_s : times_s) {
    if (!slam.solution.trajectory.at(time_s)) slam.no_pose.add(time_s);
  }
  move_to_path(recording, slam);
  slam.solve_s = seconds_since(start);
  return slam;
}

}  // namespace pingvox
