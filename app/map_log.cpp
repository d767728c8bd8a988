#include "map_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>

#include "calibration_file.hpp"
#include "console.hpp"
#include "map_report.hpp"
#include "nav_report.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/bag.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/nav.hpp"
#include "pingvox/io/tum.hpp"
#include "pingvox/nav/nav_trajectory.hpp"
#include "pingvox/slam/odometry.hpp"
#include "shell_words.hpp"
#include "step_report.hpp"

namespace pingvox::app {
namespace {

Result<BuildReport> build(const Log& log, const Trajectory& trajectory, const BuildOptions& options, OccupancyMap& map,
                          const Progress& progress) {
  if (const auto* beams = std::get_if<std::unique_ptr<BeamSource>>(&log)) {
    // Scans of points have no blanking range.
    if (const auto ranges = check_ranges(options); !ranges) return tl::unexpected(ranges.error());
    return build_map(**beams, trajectory, options, map, progress);
  }
  return build_map(*std::get<std::unique_ptr<ScanSource>>(log), trajectory, options, map, progress);
}

bool has(const NavLog& nav, NavQuantity quantity) {
  return nav.best(quantity) != nullptr;
}

bool has_position(const NavLog& nav) {
  return has(nav, NavQuantity::kPosition) || has(nav, NavQuantity::kFix);
}

/// Whether it says how the vehicle turned.
bool can_turn(const NavLog& nav) {
  return has(nav, NavQuantity::kAttitude) || has(nav, NavQuantity::kHeading) || has(nav, NavQuantity::kTurnRate);
}

/// Whether poses can be made of it: of positions and attitudes, or by dead reckoning.
bool tells_path(const NavLog& nav) {
  return has(nav, has_position(nav) ? NavQuantity::kAttitude : NavQuantity::kVelocity);
}

/// What a log has and was not used: "; not taken: /aruco/pose (580 samples: ...) (--nav-source takes it)"
std::string unused_text(const NavLog& nav, std::span<const std::string> notes) {
  std::vector<std::string> taken;
  for (const NavSource& source : nav.sources()) {
    const bool is_taken = std::ranges::none_of(nav.sources(), [&](const NavSource& other) {
      return other.name == source.name && other.subject == NavSubject::kOther;
    });
    if (is_taken) taken.push_back(source.name);
  }
  constexpr std::array kAll = {NavQuantity::kPosition, NavQuantity::kFix, NavQuantity::kAttitude, NavQuantity::kHeading,
                               NavQuantity::kVelocity};
  const std::string others = NavOthers(nav, kAll, taken).text();
  std::string text = others.empty() ? "" : fmt::format("; not taken: {} (--nav-source takes one)", others);
  for (const std::string& note : notes) text += "; " + on_one_line(note);
  return text;
}

/// How the frame of a position was read.
std::string frame_note_of(const NavLog& nav, const std::string& position) {
  for (const NavSource& source : nav.sources()) {
    if (source.name == position && source.quantity == NavQuantity::kPosition) return source.note;
  }
  return {};
}

/// "3036 of 4000 beams outside the time of the poses, 0.000 s to 24.000 s, the first at 24.043 s (--poses must cover
/// the log, with times in seconds of the same clock)"
/// @param unit  of what the log holds: "beam" or "point"
std::string text_of_skipped(const MappedLog& mapped, std::string_view unit, const VehiclePath& path,
                            const Lattice& lattice) {
  std::string text;
  const auto& [no_pose, blocked, too_long, outside] =
      std::tie(mapped.report.no_pose, mapped.report.blocked, mapped.report.too_long, mapped.report.outside);
  const std::size_t all = mapped.report.beams + no_pose.count + blocked.count + too_long.count;
  const auto add = [&text, all, unit](const LeftOut& left_out, const std::string& reason, std::string_view advice) {
    if (left_out.count == 0) return;
    text += fmt::format("{}{} of {} {}s {}", text.empty() ? "" : "; ", left_out.count, all, unit, reason);
    if (left_out.first_s) text += fmt::format(", the first at {:.3f} s", *left_out.first_s);
    text += fmt::format(" ({})", advice);
  };
  const auto& poses = path.trajectory.poses();
  add(no_pose,
      fmt::format("outside the time of the poses, {:.3f} s to {:.3f} s{}", poses.front().time_s, poses.back().time_s,
                  path.trajectory.gaps() > 0 ? ", or in one of their gaps" : ""),
      path.advice);
  add(blocked, "towards an obstacle of the map that is nearer than --min-range",
      "they would record its second echo, or what lies around it");
  add(too_long, "with ten times the range of the others, or of too many cells",
      "their range may be damaged; a shorter --max-range or a larger --resolution may do");
  add(outside,
      fmt::format("outside of the map, which reaches {:.3g} m from its origin",
                  std::ldexp(lattice.resolution_m(), lattice.depth() - 1)),
      "lengths are in metres; a larger --resolution reaches farther");
  if (mapped.damaged > 0) {
    text += (text.empty() ? "" : "; ") + damage_text(mapped.damaged, mapped.first_damage) + " (--strict stops there)";
  }
  return text;
}

void add_warnings(const std::vector<std::string>& texts, const std::string& file, VehiclePath& path) {
  for (const std::string& text : texts) path.warnings.push_back(fmt::format("{}: {}", file, text));
  if (!texts.empty()) path.advice = VehiclePath::kLeftOut;
}

}  // namespace

Result<Trajectory> trajectory_of(const std::optional<std::string>& poses, std::string_view nav_advice) {
  if (!poses) return Trajectory::still(Pose::Identity());
  const Result<FileBytes> file = read_file(*poses);
  if (!file) return tl::unexpected(file.error());
  Result<Trajectory> trajectory = read_tum(*file);
  if (trajectory) return trajectory;
  // A damaged trajectory may look like points as text.
  const std::optional<Format> format = format_of(file->view());
  if (!format || *format == Format::kTum || *format == Format::kXyz) return trajectory;
  return fail(
      Error::Code::kUnsupported,
      fmt::format("{}: is {}, not a trajectory{}", file->name, description_of(*format),
                  kind_of(*format) == FormatKind::kNav || is_bag(*format) ? fmt::format(": {}", nav_advice) : ""));
}

Result<VehiclePath> vehicle_path(const PathArgs& path, const SonarLog& log, const BagArgs& bag, Damage damage) {
  if (path.navs.empty()) {
    return trajectory_of(path.poses, "give it with --nav").map([&](const Trajectory& trajectory) {
      const CutTrajectory cut = cut_at_steps(trajectory);
      VehiclePath made{cut.trajectory, std::nullopt};
      if (path.poses) add_warnings(step_texts(cut), *path.poses, made);
      return made;
    });
  }
  const Result<NavFiles> nav = read_navs(path.navs, damage, bag.nav, {log.name, log.topic.name, path.nav_sources});
  if (!nav) return tl::unexpected(nav.error());
  if (!tells_path(nav->log)) {
    if (const std::string faults = faults_text(nav->log); !faults.empty()) {
      return fail(Error::Code::kCorrupt, fmt::format("{}: {}", fmt::join(path.navs, ", "), faults));
    }
    return fail(
        Error::Code::kUnsupported,
        fmt::format("{}: gives no path: it has no valid {}{}{}", fmt::join(path.navs, ", "),
                    has_position(nav->log) ? "attitude" : "position or velocity",
                    can_turn(nav->log) ? " ('pingvox slam' estimates the path from sonar and heading, for --poses)"
                                       : ", and no heading; another --nav may have them",
                    unused_text(nav->log, nav->notes)));
  }
  const Result<NavOffset> offset = nav_offset(path.nav_offset_s, *nav, log, damage);
  if (!offset) return tl::unexpected(offset.error());
  const std::optional<WaterAround> water = water_around(nav->log);
  const bool is_mounted = !log.body_from_sonar.matrix().isIdentity(0.0);
  const auto name_files = [&](Error error) {
    error.message = fmt::format("{}: {}", fmt::join(path.navs, ", "), error.message);
    return error;
  };
  const auto with_warnings = [&](VehiclePath made) {
    made.warnings = nav->warnings;
    if (!is_mounted) {
      const std::string hint = mount_hint(nav->bags, log.name, log.topic.name);
      if (!hint.empty()) made.warnings.push_back(hint);
    }
    if (std::ranges::any_of(nav->log.sources(), [](const NavSource& source) { return !source.steps.empty(); })) {
      made.advice = VehiclePath::kLeftOut;
    }
    return made;
  };
  if (!has_position(nav->log)) {
    OdometryOptions options{.body_from_source = {}, .offset_s = offset->offset_s};
    Eigen::Vector3d sonar_moved_m = Eigen::Vector3d::Zero();
    if (path.calibration) {
      const Result<Eigen::Vector3d> moved_m = use_calibration(*path.calibration, options);
      if (!moved_m) return tl::unexpected(moved_m.error());
      sonar_moved_m = *moved_m;
    }
    return odometry_of(nav->log, options)
        .map([&](Odometry odometry) {
          return VehiclePath{
              std::move(odometry.odometry_from_body),
              VehiclePath::Nav{odometry.heading, "", odometry.velocity, nav->damaged, *offset, water, std::nullopt,
                               NavOthers(nav->log, kMotionQuantities, std::array{odometry.heading, odometry.velocity})},
              sonar_moved_m, VehiclePath::kNavMustCover};
        })
        .map(with_warnings)
        .map_error(name_files)
        .map_error([&](Error error) {
          error.message += unused_text(nav->log, nav->notes);
          return error;
        });
  }
  if (path.calibration) {
    return fail(Error::Code::kBadOption,
                "--use-calibration: has no effect where the navigation has positions, only on "
                "dead reckoning by velocity and heading");
  }
  return nav_trajectory(nav->log, offset->offset_s)
      .map([&](NavTrajectory made) {
        return VehiclePath{
            std::move(made.trajectory),
            VehiclePath::Nav{made.attitude, made.position, "", nav->damaged, *offset, water, made.origin_fix,
                             NavOthers(nav->log, kPathQuantities, std::array{made.attitude, made.position}),
                             frame_note_of(nav->log, made.position)},
            Eigen::Vector3d::Zero(), VehiclePath::kNavMustCover};
      })
      .map(with_warnings)
      .map_error(name_files);
}

Result<VehiclePath> vehicle_positions(ByteStream nav, Damage damage, std::span<const NavFields> fields,
                                      std::span<const NamedSource> chosen) {
  const std::string name = nav.name();
  const Result<BagContents> contents = read_nav_log(std::move(nav), damage, fields);
  if (!contents) return tl::unexpected(contents.error());
  const NavFile& read = contents->nav;
  const Result<NavLog> log = chosen.empty() ? read.log : choose_named(read.log, chosen);
  if (!log) return fail(log.error().code, fmt::format("{}: {}", name, log.error().message));
  const bool has_attitude = has(*log, NavQuantity::kAttitude);
  constexpr std::array kOfTurns = {NavQuantity::kAttitude};
  if (const auto checked = check_sources(*log, kOfTurns); !checked) {
    return fail(checked.error().code, fmt::format("{}: {}", name, checked.error().message));
  }
  Result<NavTrajectory> made = has_attitude ? nav_trajectory(*log) : nav_positions(*log);
  if (!made) {
    const bool can_reckon = has(*log, NavQuantity::kVelocity);
    return fail(
        made.error().code,
        fmt::format("{}: {}{}{}", name, made.error().message,
                    can_reckon ? " ('pingvox slam --matching none' reckons them from velocity and heading)" : "",
                    unused_text(*log, contents->notes)));
  }
  VehiclePath::Nav by{made->attitude, made->position, "", damaged_records(read), {}, {}, made->origin_fix};
  by.others = NavOthers(*log, kPathQuantities, std::array{made->attitude, made->position});
  by.frame_note = frame_note_of(*log, made->position);
  VehiclePath path{std::move(made->trajectory), std::move(by)};
  add_warnings(step_texts(*log), name, path);
  return path;
}

std::string nav_text(const VehiclePath& path) {
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
  std::string text = fmt::format("{} from {}", counted(path.trajectory.poses().size(), "pose"), sources);
  if (const std::size_t gaps = path.trajectory.gaps(); gaps > 0) {
    text += ", " + counted(gaps, "gap");
  }
  if (const std::size_t damaged = path.nav->damaged; damaged > 0) {
    text += fmt::format("; skipped {}", counted(damaged, "damaged record"));
  }
  return text;
}

std::string frame_text(const VehiclePath::Nav& nav) {
  if (nav.position.empty()) return frame_text(nav.attitude);
  if (!nav.origin_fix) {
    return on_one_line(fmt::format("origin and axes are those of {}{}", nav.position,
                                   nav.frame_note.empty() ? "" : ": " + nav.frame_note));
  }
  return fmt::format("x east, y north of latitude {:.7f}, longitude {:.7f} degrees", nav.origin_fix->x() / kDegree_rad,
                     nav.origin_fix->y() / kDegree_rad);
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

Result<MappedLog> map_log(const Log& log, const std::string& name, const VehiclePath& path, const BuildOptions& options,
                          const HeadArgs& head, OccupancyMap& map, const Progress& progress) {
  const auto* beams = std::get_if<std::unique_ptr<BeamSource>>(&log);
  if (beams != nullptr && path.nav) {
    if (const auto has = check_has_times(**beams, name); !has) return tl::unexpected(has.error());
  }
  const DeviceProfile* device = beams != nullptr ? (*beams)->device() : nullptr;
  BuildOptions of_head = head.apply_to(options, device);
  of_head.body_from_sensor.pretranslate(path.sonar_moved_m);
  Result<BuildReport> report = build(log, path.trajectory, of_head, map, progress);
  if (!report) {
    // Adds the file name to errors of the map.
    const Error::Code code = report.error().code;
    if (code != Error::Code::kLimit && code != Error::Code::kNoMemory) return tl::unexpected(report.error());
    return fail(code, fmt::format("{}: {}", name, report.error().message));
  }
  MappedLog mapped;
  mapped.report = *report;
  mapped.beam = of_head.model;
  mapped.assumes_beam = beams != nullptr && head.assumes_beam(device);
  mapped.damaged = std::visit([](const auto& source) { return source->skipped(); }, log);
  mapped.first_damage = std::visit([](const auto& source) { return source->first_damage(); }, log);
  if (beams != nullptr) mapped.note = (*beams)->note();
  mapped.skipped_text = text_of_skipped(mapped, beams != nullptr ? "beam" : "point", path, map.lattice());
  const bool are_all_outside =
      report->outside.count == report->beams && report->cells_freed == 0 && report->cells_hit == 0;
  mapped.is_nothing = report->beams == 0 || are_all_outside;
  return mapped;
}

std::string text_of_nothing(const MappedLog& mapped, const std::string& name) {
  assert(mapped.is_nothing);
  return fmt::format("{}: nothing could be mapped: {}", name,
                     mapped.skipped_text.empty() ? "it is empty" : mapped.skipped_text);
}

Result<void> say_nothing_mapped(const std::vector<std::string>& texts, std::size_t logs, Console& console) {
  if (texts.size() == logs) return fail(Error::Code::kCorrupt, texts.front());
  for (const std::string& text : texts) console.say(text);
  return {};
}

std::string odd_times_text(const Trajectory& trajectory, const BuildReport& report) {
  // More than 100 times as long: likely in milliseconds.
  constexpr double kTooLong = 100.0;
  if (!report.first_s || !report.last_s) return {};
  const double poses_s = trajectory.poses().back().time_s - trajectory.poses().front().time_s;
  const double log_s = *report.last_s - *report.first_s;
  if (!(log_s > 0.0 && poses_s > kTooLong * log_s)) return {};
  return fmt::format("its poses last {:.0f} s, the log {:.0f} s: are their times in seconds?", poses_s, log_s);
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
  return is_bag(format) ? hint_at_nav(log) : "";
}

std::string hint_at_nav(const std::string& log) {
  if (log == "-") return {};
  // Of a long bag the beginning tells enough.
  constexpr std::size_t kBeginning_bytes = 32'000'000;
  const Result<BagContents> bag = ByteStream::open(log).and_then(
      [](ByteStream stream) { return read_bag(std::move(stream), Damage::kSkip, {}, kBeginning_bytes); });
  return bag && tells_path(bag->nav.log) ? "navigation in the bag is used with --nav " + quote_for_shell(log) : "";
}

}  // namespace pingvox::app
