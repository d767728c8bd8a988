#include "recording_warnings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <numbers>
#include <optional>
#include <system_error>
#include <utility>

#include "console.hpp"
#include "evaluation_text.hpp"
#include "io/internal/clock.hpp"
#include "map_report.hpp"
#include "nav_clock.hpp"
#include "nav_report.hpp"
#include "open_recording.hpp"
#include "option_names.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/bag.hpp"
#include "shell_words.hpp"
#include "step_report.hpp"

namespace pingvox::app {
namespace {

/// Warns of an angle of the mount of pi, a half or a quarter of it: in degrees that is hardly any rotation.
std::string mount_doubt(const RecordingOptions& options) {
  constexpr double kSame_deg = 5e-4;
  constexpr std::array kUsual = {std::numbers::pi, std::numbers::pi / 2.0, std::numbers::pi / 4.0};
  for (const double angle_rad : rpy_of(options.body_from_sonar.rotation())) {
    const double size_deg = std::fabs(angle_rad) / kDegree_rad;
    const auto is_same = [&](double usual) { return std::fabs(size_deg - usual) < kSame_deg; };
    if (std::ranges::none_of(kUsual, is_same)) continue;
    return fmt::format("--mount: {:.4f} degrees looks like an angle in radians: degrees are expected", size_deg);
  }
  return {};
}

/// Whether a path uses a source for the quantity that it was asked for.
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

/// Sources that were asked for and that the path does not use.
std::vector<std::string> unused_sources(const Recording& recording, const VehiclePath& path) {
  std::vector<std::string> texts;
  if (!path.nav) return texts;
  for (const NamedSource& asked : recording.options().nav_sources) {
    if (is_used(*path.nav, asked)) continue;
    const std::string quantity = asked.quantity ? std::string(name_of(*asked.quantity)) + "=" : "";
    texts.push_back(fmt::format("--nav-source {}{}: has no effect, the path is from {}", quantity, asked.name,
                                nav_sources_text(*path.nav)));
  }
  return texts;
}

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

/// What is odd about the path of a log.
std::vector<std::string> odd_path_texts(const Recording& recording, const VehiclePath& path,
                                        const BuildReport& report) {
  std::vector<std::string> texts;
  const auto add = [&](const std::string& file, const std::string& odd) {
    if (!odd.empty()) texts.push_back(fmt::format("{}: {}", file, odd));
  };
  if (path.nav) add(recording.nav_names(), odd_nav_times_text(path.trajectory, report));
  if (const auto& poses = recording.options().poses) {
    add(poses->name(), odd_times_text(path.trajectory, report));
    add(poses->name(), odd_attitudes_text(path.trajectory));
  }
  return texts;
}

/// Of the beginning of a bag, which is enough; nullopt: not a bag.
std::optional<NavLog> nav_in_bag(const std::string& log) {
  if (log == "-") return std::nullopt;
  constexpr std::size_t kBeginning_bytes = 32'000'000;
  Result<BagContents> bag = ByteStream::open(log).and_then(
      [](ByteStream stream) { return read_bag(std::move(stream), Damage::kSkip, {}, kBeginning_bytes); });
  return bag ? std::optional(std::move(bag->nav.log)) : std::nullopt;
}

std::string use_nav_in_bag(const std::string& log) {
  return "to use the navigation in the bag, give --nav " + quote_for_shell(log);
}

/// For a log that was mapped without a trajectory: where one may be, as in "its trajectory may be --poses dive.tum" or
/// "its navigation may be --nav dive.tlog" (files beside it), or `hint_at_nav`; empty: nowhere.
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
  const std::optional<NavLog> nav = nav_in_bag(log);
  if (!nav) return {};
  if (has_path(*nav)) return use_nav_in_bag(log);
  const NavSource* const fix = nav->best(NavQuantity::kFix);
  const NavSource* const place = fix != nullptr ? fix : nav->best(NavQuantity::kPosition);
  if (place == nullptr) return {};
  return fmt::format(
      "the bag has positions ({}), but no attitude: name a message that has it with --fields, or give another log "
      "with --nav",
      on_one_line(place->name));
}

}  // namespace

std::vector<std::string> nav_warnings(const Recording& recording) {
  const NavFiles& nav = recording.nav();
  const std::string names = recording.nav_names();
  std::vector<std::string> warnings;
  for (const auto& [file, note] : nav.left_out) warnings.push_back(fmt::format("{}: {}", file, note));
  if (const std::string faults = faults_text(nav.log); !faults.empty()) {
    warnings.push_back(fmt::format("{}: {}", names, faults));
  }
  const bool gives_depth = nav.log.best(NavQuantity::kDepth) == nullptr;  // a pressure, then
  for (const NavSource& source : nav.log.sources()) {
    const bool is_taken = source.quantity == NavQuantity::kPressure && source.subject != NavSubject::kOther;
    if (!gives_depth || !is_taken || source.note.empty()) continue;
    warnings.push_back(fmt::format("{}: pressure of {}: {}", names, source.name, source.note));
  }
  for (const std::string& doubt : doubt_texts(nav.log)) warnings.push_back(fmt::format("{}: {}", names, doubt));
  for (const std::string& step : step_texts(nav.log)) warnings.push_back(fmt::format("{}: {}", names, step));
  if (std::string doubt = mount_doubt(recording.options()); !doubt.empty()) warnings.push_back(std::move(doubt));
  return warnings;
}

std::string mount_hint(const Recording& recording) {
  constexpr double kSame = 1e-3;
  const RecordingOptions& options = recording.options();
  if (!options.body_from_sonar.matrix().isIdentity(0.0)) return {};
  const std::string& log = recording.logs().front().name();
  for (const BagTopicSummary& sonar : sonar_topics(recording.nav().bags, log, options.topic.name)) {
    if (!sonar.mount || sonar.mount->body_from_sensor.isApprox(Pose::Identity(), kSame)) continue;
    const Pose& pose = sonar.mount->body_from_sensor;
    // 0 instead of -0.
    const Eigen::Vector3d at = pose.translation() + Eigen::Vector3d::Zero(), rpy = rpy_of(pose.rotation());
    return on_one_line(
        fmt::format("{}: {} has the sonar's frame {} on {}, which is not used: --mount "
                    "{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}",
                    log, sonar.mount->topic, sonar.frame, sonar.mount->vehicle, at.x(), at.y(), at.z(),
                    rounded_degrees(rpy.x()) + 0.0, rounded_degrees(rpy.y()) + 0.0, rounded_degrees(rpy.z()) + 0.0));
  }
  return {};
}

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

std::string_view gap_advice(const Recording& recording, const VehiclePath& path) {
  const auto& sources = recording.nav().log.sources();
  const bool has_steps = !path.steps.empty() ||
                         std::ranges::any_of(sources, [](const NavSource& source) { return !source.steps.empty(); });
  if (has_steps) return "data after a jump is dropped";
  return path.nav ? kNavMustCover : "--poses must cover the log, with times in seconds of the same clock";
}

std::string skipped_text(const MappedLog& mapped, const Trajectory& trajectory, std::string_view gap_advice,
                         const Lattice& lattice) {
  using Why = SkippedBeams::Why;
  const auto advice_on = [&](Why why) -> std::string_view {
    switch (why) {
      case Why::kNoPose:
        return gap_advice;
      case Why::kBlocked:
        return "their echoes would be multipath, or from beside it";
      case Why::kTooLong:
        return "their range may be damaged; a shorter --max-range or a larger --resolution may help";
      case Why::kOutside:
        break;
    }
    return "lengths are in metres; a larger --resolution reaches farther, and so does --depth 32 with -o FILE.pvx";
  };
  const BuildReport& report = mapped.report;
  const std::size_t all = report.beams + report.no_pose.count + report.blocked.count + report.too_long.count;
  std::string text;
  for (const auto& [why, left_out, reason] : skipped_beams(mapped, trajectory, lattice)) {
    text += fmt::format("{}{} of {} {} {}", text.empty() ? "" : "; ", left_out.count, all,
                        mapped.has_beams ? "beams" : "points", with_option_names(reason));
    if (left_out.first_s) text += fmt::format(", the first at {:.3f} s", *left_out.first_s);
    text += fmt::format(" ({})", advice_on(why));
  }
  if (mapped.damaged > 0) {
    text += (text.empty() ? "" : "; ") + damage_text(mapped.damaged, mapped.first_damage) + " (--strict stops there)";
  }
  return text;
}

std::vector<std::string> warnings_of(const Recording& recording, const VehiclePath& path, const MappedLog& mapped,
                                     const Lattice& lattice) {
  std::vector<std::string> warnings;
  const auto add = [&](std::string_view text) { warnings.push_back(fmt::format("{}: {}", mapped.name, text)); };
  if (const auto& clock = mapped.clock_check; clock && clock->is_apart()) {
    add(wrong_clock_text(
        *clock, path.nav ? nav_offset_advice(*recording.nav_offset(), *clock) : "is the clock of --poses right?"));
  }
  if (!mapped.note.empty()) add(mapped.note);
  const std::string skipped = skipped_text(mapped, path.trajectory, gap_advice(recording, path), lattice);
  if (!skipped.empty()) add("skipped " + skipped);
  std::ranges::move(odd_path_texts(recording, path, mapped.report), std::back_inserter(warnings));
  for (const std::string& warning : coverage_warnings(mapped.report.coverage)) add(warning);
  return warnings;
}

std::string hint_at_nav(const std::string& log) {
  const std::optional<NavLog> nav = nav_in_bag(log);
  return nav && has_path(*nav) ? use_nav_in_bag(log) : "";
}

std::string still_vehicle_text(const std::string& log, Format format, const RecordingOptions& options) {
  const bool is_on_vehicle = kind_of(format) == FormatKind::kBeams || is_bag(format);
  if (!is_on_vehicle || options.poses || !options.nav.empty()) return {};
  const std::string hint = hint_at_path(log, format);
  return hint.empty() ? "" : fmt::format("{}: mapped as if the vehicle did not move; {}", log, hint);
}

std::string still_vehicle_text(const InputFile& log, const RecordingOptions& options) {
  const std::optional<Format> format = log.is_read_once() ? std::nullopt : format_of_file(log);
  return format ? still_vehicle_text(log.name(), *format, options) : "";
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
      "the logs are of several dates, {} to {}, and are mapped as if the head had not moved: map each dive by itself, "
      "or give the path of the vehicle (--poses, --nav)",
      first, last);
}

}  // namespace pingvox::app
