#include "recording_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "io/internal/clock.hpp"
#include "map_report.hpp"
#include "nav_report.hpp"
#include "open_log.hpp"
#include "option_names.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/bag.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/folder_logs.hpp"
#include "shell_words.hpp"
#include "step_report.hpp"

namespace pingvox::app {
namespace {

/// The format of a file that could not be used; nullopt: standard input, or it is unknown.
std::optional<Format> format_of_file(const InputFile& file) {
  if (file.is_standard_input()) return std::nullopt;
  const Result<Format> format = file.open().and_then([](ByteStream stream) { return identify_format(stream); });
  return format ? std::optional(*format) : std::nullopt;
}

/// Says by which option a trajectory among the navigation is taken.
Error advise_on_trajectory(Error error, const std::vector<InputFile>& files) {
  if (error.code != Error::Code::kUnsupported) return error;
  const bool has_trajectory = std::ranges::any_of(files, [](const InputFile& file) {
    const std::optional<Format> format = format_of_file(file);
    return format && kind_of(*format) == FormatKind::kTrajectory;
  });
  if (has_trajectory) error.message += ": 'map' and 'render' take it by --poses, 'locate' by --odometry";
  return error;
}

}  // namespace

Result<RecordingOptions> recording_options(const PathArgs& path, const BagArgs& bag, Damage damage) {
  RecordingOptions options;
  options.nav = input_files(path.navs);
  options.nav_offset_s = path.nav_offset_s;
  options.nav_sources = path.nav_sources;
  if (path.calibration) {
    Result<CalibrationFile> calibration = read_file(*path.calibration).and_then(read_calibration);
    if (!calibration) return tl::unexpected(calibration.error());
    options.calibration = *std::move(calibration);
  }
  if (path.poses) options.poses = *path.poses;
  options.damage = damage;
  options.topic = bag.beams;
  options.nav_fields = bag.nav;
  return options;
}

std::vector<InputFile> input_files(const std::vector<std::string>& paths) {
  return {paths.begin(), paths.end()};
}

Result<Recording> open_recording(std::vector<InputFile> logs, RecordingOptions options) {
  const std::vector<InputFile> navs = options.nav;
  const InputFile first = logs.front();
  return Recording::open(std::move(logs), std::move(options)).map_error([&](Error error) {
    const std::optional<Format> format = format_of_file(first);
    return advise_on_trajectory(format ? advise_on_log(std::move(error), *format) : std::move(error), navs);
  });
}

Result<Recording> open_recording(const RecordingArgs& args) {
  return recording_options(args.path, args.bag, args.damage).and_then([&](RecordingOptions options) {
    options.nav_mounts = args.nav_mounts;
    options.body_from_sonar = args.body_from_sonar;
    options.nav_salinity = args.nav_salinity;
    options.background_m = args.background_m;
    options.head = args.head;
    return open_recording(input_files(args.logs), std::move(options));
  });
}

Result<OpenedLog> open_log_of(const Recording& recording, std::size_t number) {
  return recording.open_log(number).map_error([&](Error error) {
    const std::optional<Format> format = format_of_file(recording.logs()[number]);
    return format ? advise_on_log(std::move(error), *format) : std::move(error);
  });
}

Result<VehiclePath> path_of(const Recording& recording) {
  const RecordingOptions& options = recording.options();
  return recording.path().map_error([&](Error error) {
    if (error.code != Error::Code::kUnsupported) return error;
    if (options.poses) {
      const std::optional<Format> format = format_of_file(*options.poses);
      if (format && (kind_of(*format) == FormatKind::kNav || is_bag(*format))) error.message += ": give it with --nav";
    } else if (!tells_path(recording.nav().log) && has_turns(recording.nav().log)) {
      error.message += "; 'pingvox slam' estimates the path from sonar and heading, for --poses";
    }
    return error;
  });
}

Result<Trajectory> trajectory_of(const std::optional<std::string>& poses, std::string_view nav_advice) {
  if (!poses) return Trajectory::still(Pose::Identity());
  return read_trajectory(*poses).map_error([&](Error error) {
    if (error.code != Error::Code::kUnsupported) return error;
    const std::optional<Format> format = format_of_file(*poses);
    const bool is_nav = format && (kind_of(*format) == FormatKind::kNav || is_bag(*format));
    if (is_nav) error.message += fmt::format(": {}", nav_advice);
    return error;
  });
}

std::vector<std::string> warnings_of(const Recording& recording, const VehiclePath& path) {
  std::vector<std::string> warnings = nav_warnings(recording);
  if (const std::string hint = mount_hint(recording); !hint.empty()) warnings.push_back(hint);
  if (!recording.options().poses) return warnings;
  if (!path.doubt.empty()) warnings.push_back(fmt::format("{}: {}", recording.options().poses->name(), path.doubt));
  const std::size_t poses = path.trajectory.poses().size() + left_out(path.steps);
  for (const std::string& step : step_texts(path.steps, poses)) {
    warnings.push_back(fmt::format("{}: {}", recording.options().poses->name(), step));
  }
  return warnings;
}

std::string nav_text(const VehiclePath& path, std::size_t damaged) {
  assert(path.nav);
  const std::string &attitude = path.nav->attitude, &position = path.nav->position, &velocity = path.nav->velocity;
  std::string sources = on_one_line(attitude.empty() ? position : attitude);
  if (!velocity.empty()) {
    sources += fmt::format(" and dead reckoning by {}: errors add up", on_one_line(velocity));
  } else if (attitude.empty()) {
    sources += ", not turned: no attitude is known";
  } else if (attitude != position) {
    sources += " and " + on_one_line(position);
  }
  if (!path.nav->depth.empty()) sources += ", depth by " + on_one_line(path.nav->depth);
  std::string text = fmt::format("{} from {}", counted(path.trajectory.poses().size(), "pose"), sources);
  if (const std::size_t gaps = path.trajectory.gaps(); gaps > 0) {
    text += ", " + counted(gaps, "gap");
  }
  if (damaged > 0) text += fmt::format("; skipped {}", counted(damaged, "damaged record"));
  return text;
}

namespace {

bool follows_log(const MapForecast& forecast, const MapOptions& asked) {
  return !asked.resolution_m && forecast.range_m;
}

/// "40 s", "5 minutes", "2.1 hours"
std::string about_text(double seconds) {
  constexpr double kMinute_s = 60.0, kHour_s = 3600.0;
  if (seconds < 2.0 * kMinute_s) return fmt::format("{:.0f} s", seconds);
  if (seconds < 2.0 * kHour_s) return fmt::format("{:.0f} minutes", seconds / kMinute_s);
  return fmt::format("{:.1f} hours", seconds / kHour_s);
}

}  // namespace

Result<std::vector<std::string>> with_logs_of_folders(const std::vector<std::string>& logs, Console& console) {
  std::vector<std::string> all;
  for (const std::string& log : logs) {
    std::error_code error;
    if (log == "-" || !std::filesystem::is_directory(log, error)) {
      all.push_back(log);
      continue;
    }
    const Result<ByteStream> bag = ByteStream::open(log);
    if (bag) {
      all.push_back(log);
      continue;
    }
    const Result<FolderLogs> found = logs_in_folder(log);
    if (!found) return tl::unexpected(found.error());
    if (found->logs.empty()) return tl::unexpected(bag.error());
    std::string text = fmt::format("{}: takes {} in it", log, counted(found->logs.size(), "log"));
    if (!found->nav.empty()) text += fmt::format("; navigation (--nav): {}", fmt::join(found->nav, ", "));
    if (!found->others.empty()) text += fmt::format("; left out: {}", fmt::join(found->others, ", "));
    console.say(text);
    all.insert(all.end(), found->logs.begin(), found->logs.end());
  }
  return all;
}

std::string resolution_text(const MapForecast& forecast, const MapOptions& asked) {
  std::string text = fmt::format("{} m", forecast.resolution_m);
  if (follows_log(forecast, asked)) {
    text += fmt::format(", by a range of {:.3g} m and a beam {:.3g} degrees wide", *forecast.range_m,
                        rounded_degrees(forecast.beam_width_rad));
  }
  return text;
}

JsonObject resolution_json(const MapForecast& forecast, const MapOptions& asked) {
  JsonObject json;
  if (!follows_log(forecast, asked)) return json.add_null("range_m").add_null("beam_width_deg");
  return json.add("range_m", *forecast.range_m).add("beam_width_deg", rounded_degrees(forecast.beam_width_rad));
}

std::string cost_text(const MapForecast& forecast) {
  constexpr double kLong_s = 30.0, kMuch_bytes = 2e9;
  const auto& cost = forecast.cost;
  if (!cost || (cost->seconds < kLong_s && cost->bytes < kMuch_bytes)) return {};
  return fmt::format(
      "{:.0f} beams of {:.3g} m in cells of {} m may take up to {} and {}; cells of twice the size (--resolution {}) "
      "take an eighth of it",
      cost->beams, forecast.range_m.value_or(0.0), forecast.resolution_m, about_text(cost->seconds),
      bytes_text(static_cast<std::size_t>(cost->bytes)), 2.0 * forecast.resolution_m);
}

std::string frame_text(const VehiclePath& path) {
  assert(path.nav);
  const VehiclePath::Nav& nav = *path.nav;
  if (nav.position.empty()) return frame_text(nav.attitude);
  if (!nav.origin_fix) {
    const std::string note = nav.frame_note.empty() ? "" : ": " + nav.frame_note;
    if (path.axes == MapAxes::kRightAhead) {
      return on_one_line(
          fmt::format("origin where {} began; x right, y ahead as the vehicle was then{}", nav.position, note));
    }
    if (!nav.north_by.empty()) {
      return on_one_line(fmt::format("origin where {} began; x east, y north as far as {} points north{}", nav.position,
                                     nav.north_by, note));
    }
    return on_one_line(fmt::format("origin and axes are those of {}{}", nav.position, note));
  }
  return fmt::format("x east, y north of latitude {:.7f}, longitude {:.7f} degrees", nav.origin_fix->x() / kDegree_rad,
                     nav.origin_fix->y() / kDegree_rad);
}

std::string frame_text(const RecordingSlam& slam) {
  const std::string& heading = slam.solution.report.heading;
  if (!slam.frame_of || (slam.frame_of->position.empty() && !slam.frame_of->origin_fix)) return frame_text(heading);
  VehiclePath path = still_path();
  path.nav = slam.frame_of;
  path.axes = MapAxes::kEastNorth;
  const std::string text = frame_text(path);
  return path.nav->north_by == heading ? text
                                       : fmt::format("{}; north as far as {} points north", text, on_one_line(heading));
}

std::string frame_text(std::string_view heading) {
  return fmt::format("origin at the first pose; x east, y north as far as {} points north", on_one_line(heading));
}

Result<void> check_ranges(const BuildOptions& options) {
  const double nearest_m = options.echo.min_range_m.value_or(0.0);
  if (options.echo.max_range_m > nearest_m) return {};
  return fail(Error::Code::kBadOption,
              fmt::format("--max-range: must be above --min-range ({:.6g} m{}), is {:.6g} m", nearest_m,
                          nearest_m == EchoOptions::kDefaultBlanking_m ? " by default" : "", options.echo.max_range_m));
}

Result<void> check_reach(const Recording& recording, const VehiclePath& path, const Lattice& lattice) {
  constexpr int kMaxDepth = 32;
  constexpr double kKilometre_m = 1000.0;
  const double reach_m = std::ldexp(lattice.resolution_m(), lattice.depth() - 1);
  const auto is_outside = [&](const StampedPose& pose) {
    return pose.map_from_body.translation().cwiseAbs().maxCoeff() > reach_m;
  };
  const auto& poses = path.trajectory.poses();
  if (poses.empty() || !std::ranges::all_of(poses, is_outside)) return {};
  const std::string name = recording.options().poses ? recording.options().poses->name() : recording.nav_names();
  return fail(Error::Code::kUnsupported,
              fmt::format("{}: the poses are {:.6g} km from the origin, and the map reaches {:.6g} km: {}make them "
                          "relative to a place near the dive",
                          name, poses.front().map_from_body.translation().norm() / kKilometre_m, reach_m / kKilometre_m,
                          lattice.depth() < kMaxDepth ? "use --depth 32 with -o FILE.pvx, or " : ""));
}

std::string_view gap_advice(const Recording& recording, const VehiclePath& path) {
  const auto& sources = recording.nav().log.sources();
  const bool has_steps = !path.steps.empty() ||
                         std::ranges::any_of(sources, [](const NavSource& source) { return !source.steps.empty(); });
  if (has_steps) return "what lies behind a jump is left out";
  return path.nav ? kNavMustCover : "--poses must cover the log, with times in seconds of the same clock";
}

std::string skipped_text(const MappedLog& mapped, std::string_view unit, const Trajectory& trajectory,
                         std::string_view gap_advice, const Lattice& lattice) {
  using Why = SkippedBeams::Why;
  const auto advice_on = [&](Why why) -> std::string_view {
    switch (why) {
      case Why::kNoPose:
        return gap_advice;
      case Why::kBlocked:
        return "they would record its second echo, or what lies around it";
      case Why::kTooLong:
        return "their range may be damaged; a shorter --max-range or a larger --resolution may do";
      case Why::kOutside:
        break;
    }
    return "lengths are in metres; a larger --resolution reaches farther, and so does --depth 32 with -o FILE.pvx";
  };
  const BuildReport& report = mapped.report;
  const std::size_t all = report.beams + report.no_pose.count + report.blocked.count + report.too_long.count;
  std::string text;
  for (const auto& [why, left_out, reason] : skipped_beams(mapped, trajectory, lattice)) {
    text += fmt::format("{}{} of {} {}s {}", text.empty() ? "" : "; ", left_out.count, all, unit,
                        with_option_names(reason));
    if (left_out.first_s) text += fmt::format(", the first at {:.3f} s", *left_out.first_s);
    text += fmt::format(" ({})", advice_on(why));
  }
  if (mapped.damaged > 0) {
    text += (text.empty() ? "" : "; ") + damage_text(mapped.damaged, mapped.first_damage) + " (--strict stops there)";
  }
  return text;
}

std::string text_of_nothing(const std::string& name, const std::string& skipped) {
  return fmt::format("{}: nothing could be mapped: {}", name, skipped.empty() ? "it is empty" : skipped);
}

Result<void> say_nothing_mapped(const std::vector<std::string>& texts, std::size_t logs, Console& console) {
  if (texts.size() == logs) return fail(Error::Code::kCorrupt, texts.front());
  for (const std::string& text : texts) console.say(text);
  return {};
}

namespace {

/// How long the poses and a log last [s], where the poses last more than 100 times as long: likely in milliseconds.
std::optional<std::pair<double, double>> odd_durations_s(const Trajectory& trajectory, const BuildReport& report) {
  constexpr double kTooLong = 100.0;
  if (!report.first_s || !report.last_s) return std::nullopt;
  const double poses_s = trajectory.poses().back().time_s - trajectory.poses().front().time_s;
  const double log_s = *report.last_s - *report.first_s;
  if (!(log_s > 0.0 && poses_s > kTooLong * log_s)) return std::nullopt;
  return std::pair(poses_s, log_s);
}

}  // namespace

std::string odd_times_text(const Trajectory& trajectory, const BuildReport& report) {
  const auto lasts_s = odd_durations_s(trajectory, report);
  if (!lasts_s) return {};
  return fmt::format("its poses last {:.0f} s, the log {:.0f} s: are their times in seconds?", lasts_s->first,
                     lasts_s->second);
}

std::string odd_nav_times_text(const Trajectory& trajectory, const BuildReport& report) {
  const auto lasts_s = odd_durations_s(trajectory, report);
  if (!lasts_s) return {};
  const auto in_log = std::ranges::count_if(trajectory.poses(), [&](const StampedPose& pose) {
    return pose.time_s >= *report.first_s && pose.time_s <= *report.last_s;
  });
  if (static_cast<double>(in_log) >= lasts_s->second) return {};
  return fmt::format("its poses last {:.0f} s, the log {:.0f} s, with {} in it: are their times in seconds?",
                     lasts_s->first, lasts_s->second, counted(static_cast<std::size_t>(in_log), "pose"));
}

std::string odd_attitudes_text(const Trajectory& trajectory) {
  constexpr std::size_t kMany = 10;
  const auto& poses = trajectory.poses();
  const auto turns = [&](const StampedPose& pose) {
    return pose.map_from_body.linear() != poses.front().map_from_body.linear();
  };
  const auto moves = [&](const StampedPose& pose) {
    return (pose.map_from_body.translation() - poses.front().map_from_body.translation()).norm() > 1.0;
  };
  if (poses.size() < kMany || std::ranges::any_of(poses, turns) || std::ranges::none_of(poses, moves)) return {};
  return "its poses move but never turn: is the attitude known?";
}

namespace {

/// Of the beginning of a long bag, which tells enough; nullopt: it is none.
std::optional<NavLog> nav_in_bag(const std::string& log) {
  if (log == "-") return std::nullopt;
  constexpr std::size_t kBeginning_bytes = 32'000'000;
  Result<BagContents> bag = ByteStream::open(log).and_then(
      [](ByteStream stream) { return read_bag(std::move(stream), Damage::kSkip, {}, kBeginning_bytes); });
  return bag ? std::optional(std::move(bag->nav.log)) : std::nullopt;
}

}  // namespace

std::string hint_at_path(const std::string& log, Format format) {
  if (log == "-") return {};
  const std::string beside = std::filesystem::path(log).replace_extension(".tum").string();
  std::error_code error;
  if (std::filesystem::is_regular_file(beside, error)) {
    return "its trajectory may be --poses " + quote_for_shell(beside);
  }
  // Named as `live` does.
  std::string navs;
  for (const std::string_view suffix : {".tlog", "-2.tlog", ".jsonl"}) {
    std::filesystem::path nav = std::filesystem::path(log).replace_extension();
    nav += suffix;
    if (std::filesystem::is_regular_file(nav, error)) navs += " --nav " + quote_for_shell(nav.string());
  }
  if (!navs.empty()) return "its navigation may be" + navs;
  if (!is_bag(format)) return {};
  if (std::string hint = hint_at_nav(log); !hint.empty()) return hint;
  const std::optional<NavLog> nav = nav_in_bag(log);
  if (!nav) return {};
  const NavSource* const fix = nav->best(NavQuantity::kFix);
  const NavSource* const place = fix != nullptr ? fix : nav->best(NavQuantity::kPosition);
  if (place == nullptr) return {};
  return fmt::format(
      "{} in the bag tells its positions, but nothing its attitude: a message that has it is named with --fields, "
      "another log is given with --nav",
      on_one_line(place->name));
}

std::string still_vehicle_text(const std::string& log, Format format, const PathArgs& path) {
  const bool is_on_vehicle = kind_of(format) == FormatKind::kBeams || is_bag(format);
  if (!is_on_vehicle || path.poses || !path.navs.empty()) return {};
  const std::string hint = hint_at_path(log, format);
  return hint.empty() ? "" : fmt::format("{}: mapped as if the vehicle did not move; {}", log, hint);
}

std::string still_vehicle_text(const InputFile& log, const PathArgs& path) {
  const std::optional<Format> format = log.is_read_once() ? std::nullopt : format_of_file(log);
  return format ? still_vehicle_text(log.name(), *format, path) : "";
}

std::string several_dates_text(std::vector<TimeSpan> logs) {
  constexpr double kPause_s = 6.0 * 3600.0;
  constexpr std::size_t kDate = 10;  // "2021-06-11"
  std::ranges::sort(logs, {}, &TimeSpan::from_s);
  const auto is_later = [](const TimeSpan& a, const TimeSpan& b) { return b.from_s - a.to_s > kPause_s; };
  if (std::ranges::adjacent_find(logs, is_later) == logs.end()) return {};
  const std::string first = date_text(logs.front().from_s).substr(0, kDate);
  const std::string last = date_text(logs.back().from_s).substr(0, kDate);
  if (first == last) return {};
  return fmt::format(
      "the logs are of several dates, {} to {}, and make one map as if the head had stood in one place all the time: "
      "map "
      "each dive by itself, or say where the vehicle was (--poses, --nav)",
      first, last);
}

std::string hint_at_nav(const std::string& log) {
  const std::optional<NavLog> nav = nav_in_bag(log);
  return nav && tells_path(*nav) ? "navigation in the bag is used with --nav " + quote_for_shell(log) : "";
}

}  // namespace pingvox::app
