#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include "command_files.hpp"
#include "device/internal/link.hpp"
#include "mapping_options.hpp"
#include "option_table.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"
#include "recording_report.hpp"
#include "shared_options.hpp"
#include "shell_words.hpp"

namespace pingvox::app {
namespace {

using Gain = ReceiverGain;

constexpr std::array kGains = {Choice<Gain>{"low", Gain::kLow}, Choice<Gain>{"normal", Gain::kNormal},
                               Choice<Gain>{"high", Gain::kHigh}};
constexpr std::array kTreeFormats = {Choice<Format>{"bt", Format::kBt}, Choice<Format>{"ot", Format::kOt},
                                     Choice<Format>{"pvx", Format::kPvx}};
constexpr double kGradian_deg = 0.9;
/// Whose options are limited to it.
constexpr std::string_view kHead = "a head", kReplayed = "a replay";

Result<LiveHead> device_from(const std::string& text) {
  constexpr std::string_view kPing360 = "ping360:", kMicron = "micron:", kReplay = "replay:";
  LiveHead device;
  if (text.starts_with(kPing360)) {
    device.kind = LiveHead::Kind::kPing360;
    device.address = text.substr(kPing360.size());
    if (device.address.starts_with("udp://") || device.address.starts_with('/')) return device;
  }
  if (text.starts_with(kMicron)) {
    device.kind = LiveHead::Kind::kMicron;
    device.address = text.substr(kMicron.size());
    for (const std::string_view line : {"/", "udp://", "tcp://"}) {
      if (device.address.starts_with(line)) return device;
    }
  }
  if (text.starts_with(kReplay) && text.size() > kReplay.size()) {
    device.kind = LiveHead::Kind::kReplay;
    device.address = text.substr(kReplay.size());
    const std::size_t at = device.address.rfind('@');
    if (at == std::string::npos) return device;
    const std::string speed = device.address.substr(at + 1);
    device.address.resize(at);
    if (speed == "max") {
      device.speed = std::numeric_limits<double>::infinity();
      return device;
    }
    const Result<double> number = number_from<double>(speed);
    if (!number) return usage_error(fmt::format("'{}': the speed after @ {}", text, number.error().message));
    if (!(*number > 0.0)) return usage_error(fmt::format("'{}': the speed after @ must be above 0, or max", text));
    device.speed = *number;
    return device;
  }
  return usage_error(
      fmt::format("no such device '{}': must be ping360:udp://HOST:PORT, ping360:/dev/ttyUSB0[@BAUD], "
                  "micron:/dev/ttyUSB0[@BAUD], micron:tcp://HOST:PORT, micron:udp://HOST:PORT or replay:FILE[@SPEED]",
                  text));
}

Result<LiveNav> navigation_from(const std::string& text) {
  constexpr std::string_view kMavlink = "mavlink:", kA50 = "a50:", kTcp = "tcp://", kA50Port = ":16171";
  if (text.starts_with("mavlink:udp://")) {
    return LiveNav{LiveNav::Kind::kMavlink, text.substr(kMavlink.size())};
  }
  if (text.starts_with("a50:tcp://")) {
    std::string address = text.substr(kA50.size());
    const std::string_view host = std::string_view(address).substr(kTcp.size());
    // The colons of "[::1]" are not that of a port.
    const bool has_port = host.find(':', host.starts_with('[') ? host.find(']') : 0) != std::string_view::npos;
    if (!has_port) address += kA50Port;
    return LiveNav{LiveNav::Kind::kA50, address};
  }
  return usage_error(
      fmt::format("no such source of navigation '{}': must be mavlink:udp://:PORT, mavlink:udp://ADDRESS:PORT or "
                  "a50:tcp://HOST[:PORT]",
                  text));
}

/// How a head is asked to move, as typed.
struct HeadMotion {
  double step_deg = kGradian_deg;
  std::optional<std::array<double, 2>> sector_deg;  ///< counter-clockwise from the first to the last
};

Take store_sector(HeadMotion& motion) {
  return [&motion](const std::string& text) -> Result<void> {
    const auto bearings = numbers_from<2>(text);
    if (!bearings) return tl::unexpected(bearings.error());
    const auto& [from_deg, to_deg] = *bearings;
    if (!(from_deg >= -360.0 && to_deg <= 360.0 && to_deg - from_deg >= kGradian_deg && to_deg - from_deg < 360.0)) {
      return usage_error(
          fmt::format("'{}': must be two bearings in degrees, the smaller one first, less than a turn apart", text));
    }
    motion.sector_deg = {from_deg, to_deg};
    return {};
  };
}

/// Steps of a motor in an angle; an error where they are no whole number of them.
Result<int> steps_in(double angle_deg, double step_deg, int max_steps) {
  const double steps = angle_deg / step_deg;
  if (steps > 0.5 && steps < max_steps + 0.5 && std::abs(steps - std::round(steps)) < 1e-6) {
    return static_cast<int>(std::lround(steps));
  }
  return usage_error(
      fmt::format("--step: must be a multiple of {} up to {:.4g}, is {}", step_deg, step_deg * max_steps, angle_deg));
}

/// Such a head would not turn, and its sweep would not end.
tl::unexpected<Error> step_beyond_sector(double step_deg) {
  return usage_error(fmt::format("--step: is {} degrees, more than --sector", step_deg));
}

Result<void> apply(const HeadMotion& motion, Ping360Settings& head) {
  const Result<int> step = steps_in(motion.step_deg, kGradian_deg, 20);
  if (!step) return tl::unexpected(step.error());
  head.step_grad = *step;
  if (!motion.sector_deg) return {};
  const auto& [from_deg, to_deg] = *motion.sector_deg;
  const int width_grad = static_cast<int>(std::lround((to_deg - from_deg) / kGradian_deg));
  if (width_grad < *step) return step_beyond_sector(motion.step_deg);
  const int left_grad = 200 - static_cast<int>(std::lround(to_deg / kGradian_deg));
  head.sector = {.first_grad = (left_grad + 800) % 400, .width_grad = std::clamp(width_grad, 1, 399)};
  return {};
}

Result<void> apply(const HeadMotion& motion, MicronSettings& head) {
  constexpr int kTurn = 6400, kAhead = 3200;
  constexpr double kStep_deg = 360.0 / kTurn;
  const Result<int> step = steps_in(motion.step_deg, kStep_deg, 255);
  if (!step) return tl::unexpected(step.error());
  head.step = *step;
  if (!motion.sector_deg) return {};
  const auto angle = [](double bearing_deg) {
    return (kAhead - static_cast<int>(std::lround(bearing_deg / kStep_deg)) + 2 * kTurn) % kTurn;
  };
  const auto& [from_deg, to_deg] = *motion.sector_deg;
  if (to_deg - from_deg < motion.step_deg) return step_beyond_sector(motion.step_deg);
  head.sector = {.left = angle(to_deg), .right = angle(from_deg)};
  return {};
}

/// Without the options of logs, which are not there while a device runs.
OptionTable::Group without(OptionTable::Group group, std::initializer_list<std::string_view> names) {
  std::erase_if(group.options,
                [&](const Option& option) { return std::ranges::find(names, option.name) != names.end(); });
  return group;
}

/// A pipe or a terminal without a reader would hold the run up, and no map can be renamed into its place. /dev/null is
/// for those who want none.
Result<void> check_is_file(const std::string& path) {
  std::error_code error;
  if (path == "/dev/null" || !std::filesystem::is_other(std::filesystem::status(path, error))) return {};
  return usage_error(
      fmt::format("-o {}: is a pipe or a device: the map is written again and again: name a file", path));
}

/// Whether SLAM tells the poses.
enum class Slam { kNo, kYes };

/// What is typed, where it is not in the command as such.
struct LiveArgs {
  BuildArgs build;
  std::optional<Format> asked_format;
  std::string output, record, poses;
  HeadMotion motion;
  double range_m = Ping360Settings().range_m;
  std::optional<double> timeout_s;
  Slam slam = Slam::kNo;
  std::map<std::string, Pose> nav_mounts;
};

Result<void> set_head(LiveCommand& command, const LiveArgs& typed) {
  Ping360Settings& ping360 = command.live.head.ping360;
  MicronSettings& micron = command.live.head.micron;
  ping360.range_m = micron.range_m = typed.range_m;
  micron.gain = ping360.gain;
  if (typed.timeout_s) ping360.timeout_s = micron.timeout_s = *typed.timeout_s;
  const bool is_micron = command.live.head.kind == LiveHead::Kind::kMicron;
  if (const auto valid = is_micron ? apply(typed.motion, micron) : apply(typed.motion, ping360); !valid) return valid;
  return is_micron ? micron.validate() : ping360.validate();
}

Result<Command> finish_live(LiveCommand command, const LiveArgs& typed, const Parsed& parsed, const Args& args) {
  const bool is_replay = command.live.head.kind == LiveHead::Kind::kReplay;
  if (const auto used = check_limited(parsed.limited, {std::string(is_replay ? kReplayed : kHead)}); !used)
    return tl::unexpected(used.error());
  const Result<Format> output_as = output_format(typed.output, typed.asked_format, kTreeFormats);
  if (!output_as) return tl::unexpected(output_as.error());
  command.format = *output_as;
  command.live.map = typed.build.map;
  command.output = typed.output;
  if (const auto valid = typed.build.echoes.validate(); !valid) return tl::unexpected(valid.error());
  command.live.build = typed.build.build_options();
  command.live.beam = typed.build.head;
  if (const auto valid = command.live.map.validate(); !valid) return tl::unexpected(valid.error());
  if (const auto valid = check_options(command.live.build); !valid) return tl::unexpected(valid.error());
  if (const auto ranges = check_ranges(command.live.build); !ranges) return tl::unexpected(ranges.error());
  if (const auto valid = set_head(command, typed); !valid) return tl::unexpected(valid.error());
  if (typed.output == "-") return usage_error("-o -: the map is written again and again: name a file");
  if (command.live.map.depth != Lattice::kDefaultDepth && *output_as != Format::kPvx) {
    return usage_error(fmt::format("{}: .{} holds maps of {} levels, not of {}: use .pvx", typed.output,
                                   name_of(*output_as), Lattice::kDefaultDepth, command.live.map.depth));
  }
  if (!typed.record.empty()) {
    if (is_replay) return usage_error("--record: a replay is a recording already");
    for (const std::string_view suffix : {".tlog", ".jsonl"}) {
      if (command.live.nav.empty()) continue;
      if (typed.record.ends_with(suffix)) {
        return usage_error(fmt::format("--record: {} is for --nav: give the sonar's log another suffix", suffix));
      }
      if (typed.output.ends_with(suffix)) {
        return usage_error(fmt::format("-o: {} is for the recording of --nav: give the map another suffix", suffix));
      }
    }
    command.live.record = typed.record;
  }
  if (!command.live.nav.empty() && is_replay) {
    return usage_error("--nav: the poses of a replay are of another time; use 'pingvox map' with --nav");
  }
  if (!typed.poses.empty()) {
    if (const auto valid = check_trajectory_output(typed.poses); !valid) return tl::unexpected(valid.error());
    command.poses = typed.poses;
  }
  if (typed.slam == Slam::kYes) command.live.slam.emplace().body_from_source = typed.nav_mounts;
  CommandFiles files;
  if (is_replay) files.read("DEVICE", command.live.head.address);
  files.read("--config", parsed.config);
  files.write("-o", typed.output);
  files.write("--record", typed.record);
  files.write("--poses-out", typed.poses);
  if (const auto valid = files.check(); !valid) return tl::unexpected(valid.error());
  if (const auto folder = check_folder_of(typed.output); !folder) return tl::unexpected(folder.error());
  if (!typed.poses.empty()) {
    if (const auto folder = check_folder_of(typed.poses); !folder) return tl::unexpected(folder.error());
  }
  if (const auto file = check_is_file(typed.output); !file) return tl::unexpected(file.error());
  command.made_by = command_text("live", args);
  return command;
}

}  // namespace

Result<Command> live_command(const Args& args) {
  LiveCommand command;
  LiveArgs typed;
  const Take device = [&](const std::string& text) -> Result<void> {
    const Result<LiveHead> taken = device_from(text);
    if (!taken) return tl::unexpected(taken.error());
    LiveHead& head = command.live.head;
    head.kind = taken->kind;
    head.address = taken->address;
    head.speed = taken->speed;
    if (taken->kind == LiveHead::Kind::kReplay) return {};
    return Link::check(taken->address);
  };
  const Take nav = [&](const std::string& text) -> Result<void> {
    const Result<LiveNav> taken = navigation_from(text);
    if (!taken) return tl::unexpected(taken.error());
    command.live.nav.push_back(*taken);
    if (taken->kind == LiveNav::Kind::kMavlink) return {};
    return Link::check(taken->address);
  };
  const Take obstacles = [&](const std::string& text) -> Result<void> {
    if (!text.starts_with("udp://")) return usage_error(fmt::format("must be udp://HOST:PORT, is '{}'", text));
    command.live.obstacles = text;
    return Link::check(text);
  };
  Option nav_mount = nav_mount_option(typed.nav_mounts);
  nav_mount.only_with = {{"--slam"}};
  OptionTable table{
      "live",
      "Maps with a scanning sonar while it runs: drives the head, records its bytes, and writes the map periodically.\n"
      "SIGINT (Ctrl-C), SIGTERM or a closed terminal (SIGHUP) finish the recording and the map; another SIGINT or\n"
      "SIGTERM, at least a second later, ends at once.",
      {{"DEVICE", Positional::Count::kOne,
        "ping360:udp://HOST:PORT, ping360:/dev/ttyUSB0[@BAUD], micron:/dev/ttyUSB0[@BAUD], micron:tcp://HOST:PORT or "
        "micron:udp://HOST:PORT (a SeaNet head: Micron, MiniKing), or replay:FILE[@SPEED], a log at the pace of its "
        "times (SPEED max: as fast as possible)",
        device}},
      {{"Output",
        {output_option(typed.output, "the map: .bt or .ot (OctoMap), .pvx (any depth)"),
         choice("--format", kTreeFormats, "format of the map where its name has none of these suffixes",
                typed.asked_format, "by suffix, else bt"),
         {"--record", 0, "FILE",
          "record the bytes of the device: a Ping360's as a log of Ping Viewer, a Micron's as a capture of packets "
          "with their times; in a folder named by the time (a FILE without a suffix is one)",
          "none", store(typed.record)},
         {"--write-every", 0, "S", "seconds from one written map to the next", number_text(command.write_every_s),
          within({0.1, 86'400.0}, store_number(command.write_every_s))},
         {"--beams", 0, "N", "stop after N beams", "never", store_number(command.max_beams)},
         flag("--json", "print one JSON object a second and one at the end, each on a line",
              command.output_options.report, Report::kJson),
         quiet_option(command.output_options),
         choice("--progress", kProgress, "show the status on standard error; auto: on a terminal",
                command.output_options.progress)}},
       {"Head",
        {{"--range", 0, "M", "range of a ping", number_text(typed.range_m),
          within(MicronSettings::kRanges_m, store_number(typed.range_m))},
         {"--sector", 0, "FROM,TO", "sector to scan, in degrees from ahead, counter-clockwise", "full turns",
          store_sector(typed.motion)},
         {"--step", 0, "DEG", "angle from beam to beam: a multiple of 0.9 (Ping360) or 0.05625 (Micron)",
          number_text(typed.motion.step_deg), store_number(typed.motion.step_deg)},
         choice("--gain", kGains, "gain of the receiver", command.live.head.ping360.gain),
         {"--timeout", 0, "S", "seconds to wait for an answer, including the turn of the head",
          fmt::format("{}, of a Micron {}", command.live.head.ping360.timeout_s, command.live.head.micron.timeout_s),
          within(kHeadTimeouts_s, store_optional(typed.timeout_s))}}},
       {"Navigation",
        {{"--nav", 0, "NAV",
          "source of the vehicle's pose: mavlink:udp://:PORT or mavlink:udp://ADDRESS:PORT, what its autopilot sends "
          "by MAVLink to this port (at all addresses of this host, or at one), or a50:tcp://HOST[:PORT], the dead "
          "reckoning of a Water Linked DVL; recorded beside --record as .tlog or .jsonl",
          "the vehicle stands still", nav, Repeats::kEachCounts},
         {"--obstacles", 0, "udp://HOST:PORT",
          "send the nearest obstacle in each of 72 sectors by MAVLink (OBSTACLE_DISTANCE), five times a second", "none",
          obstacles}}},
       {"SLAM",
        {flag(
             "--slam",
             "poses from the sonar and what --nav tells of velocity, heading and depth, less than that or nothing; the "
             "map is corrected when a place is seen again",
             typed.slam, Slam::kYes),
         std::move(nav_mount),
         only_with(
             {{"--slam"}},
             {"--poses-out", 0, "FILE",
              "write the path of the map at the end, as TUM lines 't x y z qx qy qz qw' at the times of the recording",
              "none", store(typed.poses)})}},
       map_group(typed.build),
       without(sensor_group(typed.build), {"--poses", "--nav", "--nav-source", "--nav-offset", "--use-calibration"}),
       without(echo_group(typed.build.echoes, WaterOfNav::kNo), {"--background"}),
       {"Input", {config_option()}}},
      {"pingvox live ping360:udp://192.168.2.2:9092 -o dive.ot --record dive.bin --range 20",
       "pingvox live ping360:/dev/ttyUSB0 -o dive.bt --sector -60,60 --record recordings",
       "pingvox live ping360:udp://192.168.2.2:9092 --nav mavlink:udp://:14550 -o dive.ot --record recordings",
       "pingvox live ping360:udp://192.168.2.2:9092 --nav a50:tcp://192.168.2.95 -o dive.ot --record recordings",
       "pingvox live ping360:udp://192.168.2.2:9092 --nav a50:tcp://192.168.2.95 --slam -o dive.ot --record recordings",
       "pingvox live micron:/dev/ttyUSB0 -o dive.ot --record recordings --range 20 --step 1.8",
       "pingvox live replay:dive.bin@10 -o dive.bt"},
      "Without --nav and --slam the vehicle is taken to stand still; then the map of a recording, by 'pingvox map' "
      "with the same "
      "options,\nis the same.\n"
      "Exit status: 0 done, 1 failed, also of the recording alone, 2 invalid usage."};
  for (OptionTable::Group& group : table.groups) {
    for (Option& option : group.options) {
      option.only_for.clear();  // there are no others than beams
      if (option.name == "--ray") option.only_with = {{"--beam", {"ray"}}};
      if (group.title == "Head") option.only_for = {std::string(kHead)};
    }
  }
  return parse_command(table, args, [&](const Parsed& parsed) { return finish_live(command, typed, parsed, args); });
}

}  // namespace pingvox::app
