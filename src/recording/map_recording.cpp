#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "pingvox/nav/clock_offset.hpp"
#include "pingvox/recording/recording.hpp"
#include "slam/internal/picture_turns.hpp"
#include "sonar/internal/beam_source_decorator.hpp"

namespace pingvox {
namespace {

/// A log of beams that notes the rotation of the sonar image while it is read.
class BeamsWithTurns final : public BeamSourceDecorator {
 public:
  BeamsWithTurns(std::unique_ptr<BeamSource> source, const Pose& body_from_sonar)
      : BeamSourceDecorator(std::move(source)), turns_(body_from_sonar) {}

  Result<std::optional<Beam>> next() override {
    Result<std::optional<Beam>> beam = source().next();
    if (beam && *beam) turns_.add(**beam);
    return beam;
  }

  std::optional<ClockOffset> clock_error_of(const Trajectory& trajectory) {
    const std::vector<YawChange> changes = turns_.finish();
    return clock_error(changes, turns_.pauses(), trajectory);
  }

 private:
  PictureTurns turns_;
};

/// The beams of all logs of a recording, one after another; those of points have none.
class BeamsOfRecording final : public BeamSource {
 public:
  explicit BeamsOfRecording(const Recording& recording) : recording_(recording) {}

  Result<std::optional<Beam>> next() override {
    for (;;) {
      if (log_ && log_->beams() != nullptr) {
        Result<std::optional<Beam>> beam = log_->beams()->next();
        if (!beam || *beam) return beam;
      }
      if (number_ == recording_.logs().size()) return std::nullopt;
      if (const auto opened = open_next(); !opened) return tl::unexpected(opened.error());
    }
  }

 private:
  Result<void> open_next() {
    log_.reset();
    const Result<ByteStream> stream = recording_.logs()[number_].open();
    if (!stream) return tl::unexpected(stream.error());
    const std::size_t number = number_++;
    if (stream->beginning().empty()) return {};
    Result<OpenedLog> log = recording_.open_log(number);
    if (!log) return tl::unexpected(log.error());
    log_ = *std::move(log);
    return {};
  }

  const Recording& recording_;
  std::size_t number_ = 0;
  std::optional<OpenedLog> log_;
};

Result<BuildReport> build(const OpenedLog& log, const Trajectory& trajectory, const BuildOptions& options,
                          OccupancyMap& map, const Progress& progress) {
  return log.beams() != nullptr ? build_map(*log.beams(), trajectory, options, map, progress)
                                : build_map(*log.scans(), trajectory, options, map, progress);
}

/// Why nothing of a log is on the map.
std::string why_nothing(const MappedLog& mapped, const Trajectory& trajectory, const Lattice& lattice) {
  std::string text;
  const auto add_reason = [&text](std::size_t count, std::string_view reason) {
    text += fmt::format("{}{} {}", text.empty() ? "" : "; ", count, reason);
  };
  for (const SkippedBeams& skipped : skipped_beams(mapped, trajectory, lattice)) {
    add_reason(skipped.left_out.count, skipped.reason);
    if (skipped.why == SkippedBeams::Why::kOutside) text += ": a greater depth of the map reaches farther";
  }
  if (mapped.damaged > 0) add_reason(mapped.damaged, fmt::format("damaged, the first: {}", mapped.first_damage));
  return text.empty() ? "it is empty" : text;
}

}  // namespace

Result<Background> learn_background(const Recording& recording, double range_m) {
  const auto& logs = recording.logs();
  if (std::ranges::any_of(logs, &InputFile::is_standard_input)) {
    return fail(Error::Code::kBadOption, "background_m: reads the log twice, and standard input can be read only once");
  }
  BeamsOfRecording beams(recording);
  Result<Background> background = Background::learn(beams, {.range_m = range_m});
  if (!background || !background->empty()) return background;
  return fail(Error::Code::kUnsupported,
              fmt::format("{}: background_m: needs {} beams of one direction",
                          logs.size() == 1 ? logs.front().name() : "the logs", Background::kMinBeams));
}

Result<void> subtract_background(const Recording& recording, OpenedLog& log, std::optional<Background>& background) {
  auto* const beams = std::get_if<std::unique_ptr<BeamSource>>(&log.log);
  const std::optional<double>& range_m = recording.options().background_m;
  if (beams == nullptr || !range_m) return {};
  if (!background) {
    Result<Background> learned = learn_background(recording, *range_m);
    if (!learned) return tl::unexpected(learned.error());
    background = *std::move(learned);
  }
  *beams = subtract_background(std::move(*beams), *background);
  return {};
}

std::vector<SkippedBeams> skipped_beams(const MappedLog& mapped, const Trajectory& trajectory, const Lattice& lattice) {
  using Why = SkippedBeams::Why;
  const BuildReport& report = mapped.report;
  const auto& poses = trajectory.poses();
  std::vector<SkippedBeams> all = {
      {Why::kNoPose, report.no_pose,
       fmt::format("outside the time of the poses, {:.3f} s to {:.3f} s{}", poses.front().time_s, poses.back().time_s,
                   trajectory.gaps() > 0 ? ", or in one of their gaps" : "")},
      {Why::kBlocked, report.blocked, "in whose direction the map has an obstacle nearer than min_range_m"},
      {Why::kTooLong, report.too_long, "with ten times the range of the others, or of too many cells"},
      {Why::kOutside, report.outside,
       fmt::format("outside of the map, which reaches {:.3g} m from its origin",
                   std::ldexp(lattice.resolution_m(), lattice.depth() - 1))}};
  std::erase_if(all, [](const SkippedBeams& skipped) { return skipped.left_out.count == 0; });
  return all;
}

bool MappedLog::is_nothing() const {
  const bool is_outside = report.outside.count > 0 && report.cells_freed == 0 && report.cells_hit == 0;
  return report.beams == 0 || is_outside;
}

Result<MappedLog> map_log(const Recording& recording, OpenedLog& log, const VehiclePath& path,
                          const BuildOptions& build, OccupancyMap& map, const Progress& progress) {
  const RecordingOptions& of = recording.options();
  const bool is_of_beams = log.beams() != nullptr;
  const DeviceProfile* const device = is_of_beams ? log.beams()->device() : nullptr;
  MappedLog mapped;
  mapped.name = log.name;
  mapped.has_beams = is_of_beams;
  BuildOptions options = build;
  options.model = of.head.apply_to(build.model, device);
  options.body_from_sensor = of.body_from_sonar;
  options.body_from_sensor.pretranslate(path.sonar_moved_m);
  mapped.beam = options.model;
  mapped.assumes_beam = is_of_beams && of.head.assumes_beam(device);
  BeamsWithTurns* with_turns = nullptr;
  if (is_of_beams) {
    if (path.nav) {
      if (const auto has = check_has_times(*log.beams(), log.name); !has) return tl::unexpected(has.error());
    }
    if (path.trajectory.poses().size() >= 2) {
      auto& beams = std::get<std::unique_ptr<BeamSource>>(log.log);
      auto watched = std::make_unique<BeamsWithTurns>(std::move(beams), of.body_from_sonar);
      with_turns = watched.get();
      beams = std::move(watched);
    }
  }
  const Result<BuildReport> report = pingvox::build(log, path.trajectory, options, map, progress);
  if (!report) {
    // Adds the file name to errors of the map.
    const Error::Code code = report.error().code;
    if (code != Error::Code::kLimit && code != Error::Code::kNoMemory) return tl::unexpected(report.error());
    return fail(code, fmt::format("{}: {}", log.name, report.error().message));
  }
  mapped.report = *report;
  mapped.damaged = std::visit([](const auto& source) { return source->skipped(); }, log.log);
  mapped.first_damage = std::visit([](const auto& source) { return source->first_damage(); }, log.log);
  mapped.note = std::visit([](const auto& source) { return source->note(); }, log.log);
  if (with_turns != nullptr) mapped.clock_check = with_turns->clock_error_of(path.trajectory);
  return mapped;
}

void add(const BuildReport& log, BuildReport& all) {
  const auto add_left_out = [](const LeftOut& from, LeftOut& to) {
    to.count += from.count;
    if (!to.first_s) to.first_s = from.first_s;
  };
  all.beams += log.beams;
  all.sweeps += log.sweeps;
  all.echoes += log.echoes;
  all.skipped += log.skipped;
  add_left_out(log.no_pose, all.no_pose);
  add_left_out(log.blocked, all.blocked);
  add_left_out(log.too_long, all.too_long);
  add_left_out(log.outside, all.outside);
  if (log.min_threshold) {
    all.min_threshold = std::min(all.min_threshold.value_or(*log.min_threshold), *log.min_threshold);
    all.max_threshold = std::max(all.max_threshold.value_or(*log.max_threshold), *log.max_threshold);
  }
  if (log.first_s) {
    all.first_s = std::min(all.first_s.value_or(*log.first_s), *log.first_s);
    all.last_s = std::max(all.last_s.value_or(*log.last_s), *log.last_s);
  }
  all.cells_freed += log.cells_freed;
  all.cells_hit += log.cells_hit;
  if (log.coverage.sweeps > all.coverage.sweeps) all.coverage = log.coverage;
  all.seconds.read += log.seconds.read;
  all.seconds.detect += log.seconds.detect;
  all.seconds.trace += log.seconds.trace;
  all.seconds.apply += log.seconds.apply;
}

Result<RecordingMap> build_map(const Recording& recording, const MapOptions& map, const BuildOptions& build,
                               const Progress& progress) {
  Result<VehiclePath> path = recording.path();
  if (!path) return tl::unexpected(path.error());
  return build_map(recording, *std::move(path), map, build, progress);
}

Result<RecordingMap> build_map(const Recording& recording, VehiclePath path, const MapOptions& map,
                               const BuildOptions& build, const Progress& progress) {
  Result<MapForecast> forecast = forecast_map(recording, map, build);
  if (!forecast) return tl::unexpected(forecast.error());
  Result<OccupancyMap> made = make_map(*forecast, map);
  if (!made) return tl::unexpected(made.error());
  RecordingMap mapped{*std::move(made), *std::move(forecast), {}, std::move(path), {}};
  BuildOptions options = build;
  if (recording.water()) options.sound_speed_ratio = sound_speed_ratio(*recording.water());
  std::optional<Background> background;
  for (std::size_t i = 0; i < recording.logs().size(); ++i) {
    auto opened = mapped.forecast.opened.extract(i);
    Result<OpenedLog> log = opened ? std::move(opened.mapped()) : recording.open_log(i);
    if (!log) return tl::unexpected(log.error());
    if (const auto done = subtract_background(recording, *log, background); !done) return tl::unexpected(done.error());
    Result<MappedLog> done = map_log(recording, *log, mapped.path, options, mapped.map, progress);
    if (!done) return tl::unexpected(done.error());
    add(done->report, mapped.report);
    mapped.logs.push_back(*std::move(done));
  }
  if (std::ranges::all_of(mapped.logs, &MappedLog::is_nothing)) {
    const MappedLog& first = mapped.logs.front();
    return fail(Error::Code::kCorrupt, fmt::format("{}: nothing could be mapped: {}", first.name,
                                                   why_nothing(first, mapped.path.trajectory, mapped.map.lattice())));
  }
  return mapped;
}

}  // namespace pingvox
