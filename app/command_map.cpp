#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <ranges>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "campaign.hpp"
#include "commands.hpp"
#include "evaluation_text.hpp"
#include "input_kinds.hpp"
#include "io/internal/clock.hpp"
#include "io/internal/json.hpp"
#include "map_report.hpp"
#include "nav_clock.hpp"
#include "nav_report.hpp"
#include "open_log.hpp"
#include "open_recording.hpp"
#include "option_values.hpp"
#include "pingvox/analysis/cut_tree.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/sonar/device_profile.hpp"
#include "progress.hpp"
#include "recording_report.hpp"
#include "recording_warnings.hpp"
#include "shell_words.hpp"
#include "stopwatch.hpp"
#include "threshold_range.hpp"
#include "watched_cloud.hpp"

namespace pingvox::app {
namespace {

/// Totals of all logs.
struct Totals {
  BuildReport report;
  std::size_t scans = 0, points = 0;  ///< scans of points, and their points
  std::size_t damaged = 0;
  struct UsedBeam {
    std::string log;
    BeamModelOptions model;
    bool is_assumed;  ///< its size is a default
  };
  std::vector<UsedBeam> used_beams;  ///< of logs of beams, those that differ
  double sound_speed_m_s = kAssumedSoundSpeed_m_s;
  /// By how much the clock of the poses is off, by the turning of the sonar's picture: the greatest of all logs.
  std::optional<ClockOffset> clock_check;
  double write_s = 0.0, total_s = 0.0;

  void add(const MappedLog& mapped, const OpenedLog& source) {
    pingvox::add(mapped.report, report);
    damaged += mapped.damaged;
    const auto is_same = [&](const UsedBeam& used) {
      return used.model.width_rad == mapped.beam.width_rad && used.model.height_rad == mapped.beam.height_rad &&
             used.is_assumed == mapped.assumes_beam;
    };
    if (source.scans() != nullptr) {
      scans += mapped.report.sweeps;
      points += mapped.report.beams;
    } else if (std::ranges::none_of(used_beams, is_same)) {
      used_beams.push_back({mapped.name, mapped.beam, mapped.assumes_beam});
    }
  }
};

std::optional<double> share_read(const OpenedLog& log) {
  return std::visit([](const auto& source) { return source->share_read(); }, log.log);
}

std::string_view name_of(BeamShape shape) {
  return shape == BeamShape::kRay ? "ray" : shape == BeamShape::kFan ? "fan" : "cone";
}

/// "cone, 3 degrees wide, 35 high"
std::string beam_text(const BeamModelOptions& model, bool is_assumed) {
  std::string text(name_of(model.shape));
  if (model.shape == BeamShape::kFan) text += fmt::format(", {:.6g} degrees wide", rounded_degrees(model.width_rad));
  if (model.shape == BeamShape::kCone) {
    text += fmt::format(", {:.6g} degrees wide, {:.6g} high", rounded_degrees(model.width_rad),
                        rounded_degrees(model.height_rad));
  }
  if (is_assumed && model.shape != BeamShape::kRay) text += ", assumed (the log names no sonar: see --device)";
  return text;
}

JsonObject beam_json(const BeamModelOptions& model) {
  JsonObject json;
  json.add("shape", name_of(model.shape));
  model.shape == BeamShape::kRay ? json.add_null("width_deg") : json.add("width_deg", rounded_degrees(model.width_rad));
  model.shape == BeamShape::kCone ? json.add("height_deg", rounded_degrees(model.height_rad))
                                  : json.add_null("height_deg");
  return json;
}

JsonObject threshold_json(const BuildReport& report) {
  JsonObject json;
  if (!report.min_threshold) return json.add_null("min").add_null("max");
  return json.add("min", *report.min_threshold).add("max", *report.max_threshold);
}

JsonObject nav_json(const Recording& recording, const VehiclePath& path,
                    const std::optional<ClockOffset>& clock_check) {
  const std::vector<std::string> warnings = warnings_of(recording, path);
  JsonObject json;
  json.add("attitude", path.nav->attitude)
      .add("position", path.nav->position)
      .add("poses", path.trajectory.poses().size())
      .add("gaps", path.trajectory.gaps())
      .add("skipped", recording.nav().damaged)
      .add("velocity", path.nav->velocity)
      .add("clock", json_of(*recording.nav_offset()))
      .add("logs", nav_logs_json(recording.nav().clocks))
      .add("frame", frame_text(path));
  if (!warnings.empty()) json.add("warnings", fmt::format("{}", fmt::join(warnings, "; ")));
  clock_check ? json.add("clock_check", json_of(*clock_check)) : json.add_null("clock_check");
  return json.add("others", json_of(path.nav->others));
}

std::string report_json(const Totals& totals, const Recording& recording, const VehiclePath& path,
                        const OccupancyMap& map, const JsonObject& resolution_from) {
  const BuildReport& report = totals.report;
  JsonObject seconds;
  seconds.add("read", round_to_us(report.seconds.read))
      .add("detect", round_to_us(report.seconds.detect))
      .add("trace", round_to_us(report.seconds.trace))
      .add("apply", round_to_us(report.seconds.apply))
      .add("write", round_to_us(totals.write_s))
      .add("total", round_to_us(totals.total_s));
  std::vector<JsonObject> other_beams;
  for (const auto& used : totals.used_beams | std::views::drop(1)) {
    other_beams.push_back(beam_json(used.model).add("log", used.log));
  }
  JsonObject json;
  JsonObject skipped_for;
  skipped_for.add("damage", totals.damaged)
      .add("no_pose", report.no_pose.count)
      .add("blocked", report.blocked.count)
      .add("too_long", report.too_long.count)
      .add("outside_map", report.outside.count);
  json.add("beams", report.beams)
      .add("sweeps", report.sweeps)
      .add("echoes", report.echoes)
      .add("skipped", report.skipped)
      .add("skipped_for", skipped_for);
  totals.used_beams.empty() ? json.add_null("beam") : json.add("beam", beam_json(totals.used_beams.front().model));
  json.add("threshold", threshold_json(report))
      .add("sound_speed_m_s", totals.sound_speed_m_s)
      .add("cells_freed", report.cells_freed)
      .add("cells_hit", report.cells_hit)
      .add("seconds", seconds)
      .add("map", map_json(map, map.counts()))
      .add("resolution_from", resolution_from);
  if (report.coverage.sweeps > 0) json.add("coverage", coverage_json(report.coverage));
  if (!other_beams.empty()) json.add("other_beams", other_beams);
  if (path.nav) json.add("nav", nav_json(recording, path, totals.clock_check));
  return json.text() + "\n";
}

std::string map_report_text(const Totals& totals, const Recording& recording, const VehiclePath& path,
                            const OccupancyMap& map, const MapForecast& forecast, const MapCommand& command) {
  const std::string& output = command.output;
  const BuildReport& report = totals.report;
  const auto& s = report.seconds;
  std::string read;
  if (const std::size_t beams = report.beams - totals.points; beams > 0) {
    const std::size_t echoes = report.echoes - totals.points;
    read = beams_text(beams, report.sweeps - totals.scans, echoes);
    if (beams > echoes) read += fmt::format(", {} without echo", counted(beams - echoes, "beam"));
  }
  if (totals.scans > 0) {
    read += fmt::format("{}{} in {}", read.empty() ? "" : ", ", counted(totals.points, "point"),
                        counted(totals.scans, "scan"));
  }
  if (report.skipped > 0) read += fmt::format("; {} skipped", report.skipped);
  const std::string name = output == "-" ? "standard output" : on_one_line(output);
  const bool stands_still = !totals.used_beams.empty() && !path.nav && !command.recording.path.poses;
  std::string beams;
  for (const auto& [log, model, is_assumed] : totals.used_beams) {
    const std::string of_log = totals.used_beams.size() > 1 ? on_one_line(log) + ": " : "";
    beams += report_line("beam", of_log + beam_text(model, is_assumed));
  }
  if (!totals.used_beams.empty()) {
    const ThresholdRange thresholds{report.min_threshold, report.max_threshold};
    beams += report_line("threshold", thresholds.text(command.build.echo.threshold));
  }
  beams +=
      recording.water() ? report_line("water", water_text(*recording.water())) : sound_line(totals.sound_speed_m_s);
  return name + "\n" + report_line("read", read) +
         (path.nav ? report_line("nav", nav_text(path, recording.nav().damaged)) + others_line(path.nav->others) +
                         report_line("nav clock", app::text_of(*recording.nav_offset(), totals.clock_check)) +
                         nav_logs_text(recording.nav().clocks) + report_line("frame", frame_text(path)) +
                         mount_line(command.recording)
                   : "") +
         (report.coverage.sweeps > 0 ? report_line("sweeps", movement_text(report.coverage)) +
                                           report_line("places", places_text(report.coverage))
                                     : "") +
         (stands_still ? report_line("vehicle", "stands still: no --poses, no --nav") : "") + beams +
         map_text(map, map.counts(), resolution_text(forecast, command.map)) +
         report_line("seconds",
                     fmt::format("{:.3f} = {:.3f} read + {:.3f} detect + {:.3f} trace + {:.3f} apply + {:.3f} "
                                 "write + rest",
                                 totals.total_s, s.read, s.detect, s.trace, s.apply, totals.write_s));
}

/// Maps the logs of a command, one by one.
class LogMapper {
 public:
  LogMapper(const MapCommand& command, const Recording& recording, MapForecast& forecast, const VehiclePath& path,
            const BuildOptions& build, OccupancyMap& map, Totals& totals, Console& console)
      : command_(command),
        recording_(recording),
        forecast_(forecast),
        path_(path),
        build_(build),
        map_(map),
        totals_(totals),
        console_(console),
        bar_(command.output_options) {}

  /// Maps the next log.
  Result<void> add_next() {
    const std::size_t number = opened_++;
    const Stopwatch read;
    if (command_.recording.logs.size() > 1) {
      const Result<bool> is_empty = is_empty_file(number);
      if (!is_empty) return tl::unexpected(is_empty.error());
      if (*is_empty) {
        nothing_.push_back(fmt::format("{}: is empty", command_.recording.logs[number]));
        return check_options_used();
      }
    }
    auto opened = forecast_.opened.extract(number);
    Result<OpenedLog> log = opened ? std::move(opened.mapped()) : open_log_of(recording_, number);
    if (!log) return tl::unexpected(log.error());
    add_kinds(*log);
    if (const auto used = check_options_used(); !used) return used;
    if (log->beams() != nullptr) {
      if (const auto ranges = check_ranges(build_); !ranges) return ranges;
    }
    if (const auto done = subtract_background(recording_, *log, background_); !done) return done;
    totals_.report.seconds.read += read.seconds();
    return map(*log);
  }

  /// Names the logs of which nothing is on the map; kCorrupt when these are all of them.
  Result<void> finish() {
    bar_.clear();
    if (path_.trajectory.poses().size() < 2) {
      if (const std::string text = several_dates_text(dates_); !text.empty()) say(text);
    }
    return say_nothing_mapped(nothing_, command_.recording.logs.size(), console_);
  }

 private:
  void add_kind(std::string kind) {
    if (std::ranges::find(kinds_, kind) == kinds_.end()) kinds_.push_back(std::move(kind));
  }

  Result<bool> is_empty_file(std::size_t number) const {
    const InputFile& file = recording_.logs()[number];
    if (file.is_read_once()) return false;
    return file.open().map([](const ByteStream& stream) { return stream.beginning().empty(); });
  }

  Result<void> map(OpenedLog& log) {
    const WatchedCloud* const cloud = watch_cloud(log);
    const Progress progress = [&](const BuildReport& done) { draw(share_read(log), done.beams); };
    const Result<MappedLog> mapped = map_log(recording_, log, path_, build_, map_, progress);
    if (!mapped) return tl::unexpected(mapped.error());
    totals_.add(*mapped, log);
    if (mapped->clock_check) add_clock(*mapped->clock_check);
    if (mapped->is_nothing()) {
      nothing_.push_back(text_of_nothing(
          log.name, skipped_text(*mapped, path_.trajectory, gap_advice(recording_, path_), map_.lattice())));
      if (cloud != nullptr && mapped->report.outside.count > 0) {
        nothing_.back() += "; they are " + cloud->origin_text() + ", and --depth 32 (.pvx) reaches farther";
      }
      return {};
    }
    for (const std::string& warning : warnings_of(recording_, path_, *mapped, map_.lattice())) say(warning);
    if (cloud != nullptr && cloud->is_far()) say(fmt::format("{}: its points are {}", log.name, cloud->origin_text()));
    if (const std::string text = still_vehicle_text(log.name, log.format, recording_.options()); !text.empty()) {
      say(text);
    }
    if (mapped->has_beams) note_dates(*mapped);
    return {};
  }

  /// Kinds of a log, which options may be limited to.
  void add_kinds(const OpenedLog& log) {
    const bool is_beams = log.beams() != nullptr;
    const bool is_bag_of_scans = is_bag(log.format) && !is_beams;
    add_kind(kind_text(is_bag_of_scans ? FormatKind::kScans : kind_of(log.format)));
    if (is_bag_of_scans) add_kind(std::string(kBagScans));
    if (is_beams && build_.model.shape == BeamShape::kRay) add_kind(std::string(kRayBeams));
  }

  /// Options without effect are known with the last log, before it is mapped.
  Result<void> check_options_used() const {
    if (opened_ < command_.recording.logs.size() || kinds_.empty()) return {};
    return check_limited(command_.limited, kinds_).map_error([](const Error& error) {
      return Error{error.code, fmt::format("map: {}", error.message)};
    });
  }

  void draw(std::optional<double> share, std::size_t beams) {
    if (!bar_.is_due()) return;
    // All logs count the same, as the length of later ones is unknown.
    if (share)
      share = (static_cast<double>(opened_ - 1) + *share) / static_cast<double>(command_.recording.logs.size());
    bar_.draw(share, fmt::format("{}, {}, {}", counted(totals_.report.beams + beams, "beam"), time_text(share),
                                 bytes_text(map_.memory_bytes())));
  }

  /// "12 s, 34 s left"
  std::string time_text(std::optional<double> share) const {
    constexpr double kFirst_s = 1.0, kFirstShare = 0.01;  // before that it would be a guess
    const double done_s = total_.seconds();
    std::string done = fmt::format("{:.0f} s", done_s);
    if (!share || done_s < kFirst_s || *share < kFirstShare) return done;
    return fmt::format("{}, {:.0f} s left", done, done_s * (1.0 - *share) / *share);
  }

  /// A cloud whose origin was not given. nullptr: else.
  const WatchedCloud* watch_cloud(OpenedLog& log) const {
    auto* scans = std::get_if<std::unique_ptr<ScanSource>>(&log.log);
    if (scans == nullptr || kind_of(log.format) != FormatKind::kCloud || command_.recording.cloud_origin_m)
      return nullptr;
    auto watched = std::make_unique<WatchedCloud>(std::move(*scans), build_.echo.max_range_m, map_.lattice());
    const WatchedCloud* const source = watched.get();
    *scans = std::move(watched);
    return source;
  }

  void add_clock(const ClockOffset& error) {
    std::optional<ClockOffset>& greatest = totals_.clock_check;
    if (!greatest || std::abs(error.offset_s) > std::abs(greatest->offset_s)) greatest = error;
  }

  /// By the clock of the log, else by the date in its name.
  void note_dates(const MappedLog& mapped) {
    if (!mapped.report.first_s || !mapped.report.last_s) return;
    TimeSpan span{*mapped.report.first_s, *mapped.report.last_s};
    if (date_text(span.from_s).empty()) {
      const std::optional<double> start_s = date_in_name(mapped.name);
      if (!start_s) return;
      span = {*start_s, *start_s + span.duration_s()};
    }
    dates_.push_back(span);
  }

  void say(const std::string& text) {
    bar_.clear();
    console_.say(text);
  }

  const MapCommand& command_;
  const Recording& recording_;
  MapForecast& forecast_;
  const VehiclePath& path_;
  const BuildOptions& build_;
  OccupancyMap& map_;
  Totals& totals_;
  Console& console_;
  ProgressBar bar_;
  std::optional<Background> background_;  ///< of all logs, once one has beams
  Stopwatch total_;
  std::size_t opened_ = 0;
  std::vector<TimeSpan> dates_;       ///< of the logs of beams that have them
  std::vector<std::string> kinds_;    ///< of the logs
  std::vector<std::string> nothing_;  ///< texts of logs of which nothing is on the map
};

}  // namespace

Result<int> run(const MapCommand& typed, Console& console) {
  if (typed.campaign) return map_campaign(typed, console);
  const Stopwatch total;
  MapCommand command = typed;
  if (const auto found = expand_folders(command.recording.logs, console); !found) return tl::unexpected(found.error());
  const Result<OpenedRecording> opened = open_with_path(command.recording);
  if (!opened) return tl::unexpected(opened.error());
  const auto& [recording, path] = *opened;
  for (const std::string& warning : warnings_of(recording, path)) console.say(warning);
  BuildOptions build = command.build;
  if (recording.water()) build.sound_speed_ratio = sound_speed_ratio(*recording.water());
  Result<MapForecast> forecast = forecast_map(recording, command.map, build);
  if (!forecast) return tl::unexpected(forecast.error());
  Result<OccupancyMap> map = make_map(*forecast, command.map);
  if (!map) return tl::unexpected(map.error());
  if (const auto reached = check_reach(recording, path, map->lattice()); !reached) {
    return tl::unexpected(reached.error());
  }
  if (const std::string cost = cost_text(*forecast); !cost.empty()) console.say(cost);
  Totals totals;
  totals.sound_speed_m_s = build.sound_speed_ratio * kAssumedSoundSpeed_m_s;

  {
    LogMapper mapper(command, recording, *forecast, path, build, *map, totals, console);
    for (std::size_t i = 0; i < command.recording.logs.size(); ++i) {
      if (const auto added = mapper.add_next(); !added) return tl::unexpected(added.error());
    }
    if (const auto done = mapper.finish(); !done) return tl::unexpected(done.error());
  }
  if (command.occupancy.cut_depth) map = cut_tree(*map, *command.occupancy.cut_depth);

  const Stopwatch write;
  const Result<void> written = write_map(*map, command.format, command.made_by, command.output, path.axes);
  if (!written) return tl::unexpected(written.error());
  totals.write_s = write.seconds();
  totals.total_s = total.seconds();

  const Result<void> summary =
      command.output_options.report == Report::kJson
          ? console.print(report_json(totals, recording, path, *map, resolution_json(*forecast, command.map)))
          : console.summarise(map_report_text(totals, recording, path, *map, *forecast, command), command.output);
  if (!summary) return tl::unexpected(summary.error());
  if (map->empty()) {
    console.say(empty_map_text(command.output));
  }
  return 0;
}

}  // namespace pingvox::app
