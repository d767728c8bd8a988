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
#include "open_recording.hpp"
#include "option_names.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/bag.hpp"
#include "shell_words.hpp"
#include "step_report.hpp"

namespace pingvox::app {
namespace {

/// "ATTITUDE and LOCAL_POSITION_NED, depth by SCALED_PRESSURE2"
std::string nav_sources_text(const VehiclePath::Nav& nav) {
  std::string sources = on_one_line(nav.attitude.empty() ? nav.position : nav.attitude);
  if (!nav.velocity.empty()) {
    sources += fmt::format(" and dead reckoning by {}: errors add up", on_one_line(nav.velocity));
  } else if (nav.attitude.empty()) {
    sources += ", not turned: no attitude is known";
  } else if (nav.attitude != nav.position) {
    sources += " and " + on_one_line(nav.position);
  }
  if (!nav.depth.empty()) sources += ", depth by " + on_one_line(nav.depth);
  return sources;
}

/// Whether a path is made of a source that was asked for, by the quantity that it was asked for.
bool is_used(const VehiclePath::Nav& path, const NamedSource& asked) {
  const auto is_asked = [&](const std::string& used) { return used.find(asked.name) != std::string::npos; };
  if (!asked.quantity) {
    return is_asked(path.attitude) || is_asked(path.position) || is_asked(path.velocity) || is_asked(path.depth);
  }
  switch (*asked.quantity) {
    case NavQuantity::kPosition:
    case NavQuantity::kFix:
      return is_asked(path.position);
    case NavQuantity::kAttitude:
    case NavQuantity::kHeading:
      return is_asked(path.attitude);
    case NavQuantity::kVelocity:
      return is_asked(path.velocity);
    case NavQuantity::kDepth:
    case NavQuantity::kPressure:
      return is_asked(path.depth);
    case NavQuantity::kTemperature:
      return true;  // of the water
    case NavQuantity::kTurnRate:
    case NavQuantity::kRange:
      return false;
  }
  return false;
}

/// Sources that were asked for and are no part of the path.
std::vector<std::string> unused_sources(const Recording& recording, const VehiclePath& path) {
  std::vector<std::string> texts;
  if (!path.nav) return texts;
  for (const NamedSource& asked : recording.options().nav_sources) {
    if (is_used(*path.nav, asked)) continue;
    const std::string quantity = asked.quantity ? std::string(name_of(*asked.quantity)) + "=" : "";
    texts.push_back(fmt::format("--nav-source {}{}: has no effect, the path is by {}", quantity, asked.name,
                                nav_sources_text(*path.nav)));
  }
  return texts;
}

}  // namespace

std::vector<std::string> warnings_of(const Recording& recording, const VehiclePath& path) {
  std::vector<std::string> warnings = nav_warnings(recording);
  std::ranges::move(unused_sources(recording, path), std::back_inserter(warnings));
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
  std::string text =
      fmt::format("{} from {}", counted(path.trajectory.poses().size(), "pose"), nav_sources_text(*path.nav));
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

/// "its poses last 156750 s, the log 157 s: are their times in seconds?"; empty: nothing is odd.
std::string odd_times_text(const Trajectory& trajectory, const BuildReport& report) {
  const auto lasts_s = odd_durations_s(trajectory, report);
  if (!lasts_s) return {};
  return fmt::format("its poses last {:.0f} s, the log {:.0f} s: are their times in seconds?", lasts_s->first,
                     lasts_s->second);
}

/// "its poses last 29900 s, the log 27 s, with 1 pose in it: ..."; empty: nothing is odd. Navigation may well be longer
/// than a log, but then has poses in it.
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

/// "its poses move but never turn: is the attitude known?"; empty: nothing is odd.
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

}  // namespace

std::vector<std::string> odd_path_texts(const Recording& recording, const VehiclePath& path, const PathArgs& args,
                                        const BuildReport& report) {
  std::vector<std::string> texts;
  const auto add = [&](const std::string& file, const std::string& odd) {
    if (!odd.empty()) texts.push_back(fmt::format("{}: {}", file, odd));
  };
  if (path.nav) add(recording.nav_names(), odd_nav_times_text(path.trajectory, report));
  if (args.poses) {
    add(*args.poses, odd_times_text(path.trajectory, report));
    add(*args.poses, odd_attitudes_text(path.trajectory));
  }
  return texts;
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
