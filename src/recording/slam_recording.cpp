#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>

#include "io/internal/beams_in_order.hpp"
#include "pingvox/recording/recording.hpp"

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
  options.nav_offset_s = recording.nav_offset().offset_s;
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

/// Gives the smoother the beams of a log.
Result<void> add_beams(const Recording& recording, OpenedLog log, SlamSmoother& smoother, RecordingSlam& slam) {
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
    smoother.add(std::move(**beam));
  }
  slam.skipped += beams->skipped();
  if (const std::string note = beams->note(); !note.empty()) slam.notes.push_back({name, note});
  return {};
}

}  // namespace

VehiclePath RecordingSlam::path() const {
  VehiclePath path{.trajectory = solution.trajectory};
  if (options.matching == Matching::kPairs) {
    path.sonar_moved_m = sonar_moved_by(solution.calibration);
  } else if (options.calibration) {
    path.sonar_moved_m = sonar_moved_by(*options.calibration);
  }
  return path;
}

Result<RecordingSlam> slam(const Recording& recording, const SlamOptions& options, std::optional<OpenedLog> first) {
  auto start = std::chrono::steady_clock::now();
  RecordingSlam slam{{Trajectory::still(Pose::Identity()), {}, {}, {}}, options_for(recording, options)};
  if (const auto valid = slam.options.validate(); !valid) return tl::unexpected(valid.error());
  SlamSmoother smoother(slam.options);
  if (const auto added = smoother.add(recording.nav().log); !added) {
    return fail(added.error().code, fmt::format("{}: {}", recording.nav_names(), added.error().message));
  }
  slam.skipped = recording.nav().damaged;
  for (std::size_t i = 0; i < recording.logs().size(); ++i) {
    Result<OpenedLog> log = i == 0 && first ? *std::exchange(first, std::nullopt) : recording.open_log(i);
    if (!log) return tl::unexpected(log.error());
    if (const auto added = add_beams(recording, *std::move(log), smoother, slam); !added) {
      return tl::unexpected(added.error());
    }
  }
  slam.read_s = seconds_since(start);
  start = std::chrono::steady_clock::now();
  Result<SlamSolution> solution = smoother.solve();
  if (!solution) {
    return fail(solution.error().code, fmt::format("{}: {}", names_of(recording), solution.error().message));
  }
  slam.solution = *std::move(solution);
  slam.solve_s = seconds_since(start);
  return slam;
}

}  // namespace pingvox
