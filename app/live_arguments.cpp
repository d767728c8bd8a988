#include "live_arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <limits>
#include <ranges>
#include <string_view>
#include <utility>

#include "device/internal/link.hpp"
#include "echo_options.hpp"
#include "nav_options.hpp"
#include "option_values.hpp"
#include "slam_options.hpp"

namespace pingvox::app {
namespace {

using Gain = ReceiverGain;

constexpr std::array kGains = {Choice<Gain>{"low", Gain::kLow}, Choice<Gain>{"normal", Gain::kNormal},
                               Choice<Gain>{"high", Gain::kHigh}};
/// Those with one layout of their messages are alike.
constexpr std::array kDistributions = {Choice<Ros2Distribution>{"humble", Ros2Distribution::kHumble},
                                       Choice<Ros2Distribution>{"iron", Ros2Distribution::kIron},
                                       Choice<Ros2Distribution>{"jazzy", Ros2Distribution::kIron},
                                       Choice<Ros2Distribution>{"kilted", Ros2Distribution::kIron},
                                       Choice<Ros2Distribution>{"rolling", Ros2Distribution::kIron}};
/// Whose options are limited to it.
constexpr std::string_view kHead = "a head", kSharedHead = "a head that another program drives", kReplayed = "a replay";

std::string_view kind_of_device(LiveHead::Kind kind) {
  switch (kind) {
    case LiveHead::Kind::kReplay:
      return kReplayed;
    case LiveHead::Kind::kSharedPing360:
    case LiveHead::Kind::kPingViewer2:
    case LiveHead::Kind::kRos2:
      return kSharedHead;
    case LiveHead::Kind::kPing360:
    case LiveHead::Kind::kMicron:
      break;
  }
  return kHead;
}

/// Whether an address is without the port behind its host. The colons of "[::1]" are not that of a port.
bool lacks_port(std::string_view host) {
  return host.find(':', host.starts_with('[') ? host.find(']') : 0) == std::string_view::npos;
}

/// With the slash that begins the name of a topic.
constexpr std::string_view kRos2Topic = "ros2:/";

Result<LiveHead> device_from(const std::string& text) {
  constexpr std::string_view kPing360 = "ping360:", kMicron = "micron:", kReplay = "replay:",
                             kListen = "ping360-listen:", kPingViewer2 = "pingviewer2:";
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
  if (text.starts_with(kListen)) {
    device.kind = LiveHead::Kind::kSharedPing360;
    device.address = text.substr(kListen.size());
    if (device.address.starts_with("udp://")) return device;
  }
  if (text.starts_with(kRos2Topic)) {
    device.kind = LiveHead::Kind::kRos2;
    device.address = text.substr(kRos2Topic.size() - 1);
    return device;
  }
  if (text.starts_with(kPingViewer2) && text.size() > kPingViewer2.size()) {
    device.kind = LiveHead::Kind::kPingViewer2;
    std::string host = text.substr(kPingViewer2.size());
    const std::size_t slash = std::min(host.find('/'), host.size());
    if (slash < host.size()) device.device = host.substr(slash + 1);
    host.resize(slash);
    if (lacks_port(host)) host += ":6060";
    device.address = "tcp://" + host;
    return device;
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
  return usage_error(fmt::format(
      "no such device '{}': must be ping360:udp://HOST:PORT, ping360:/dev/ttyUSB0[@BAUD], "
      "micron:/dev/ttyUSB0[@BAUD], micron:tcp://HOST:PORT, micron:udp://HOST:PORT, "
      "pingviewer2:HOST[:PORT][/DEVICE], ping360-listen:udp://HOST:PORT, ros2:/TOPIC or replay:FILE[@SPEED]",
      text));
}

tl::unexpected<Error> no_such_navigation(const std::string& text) {
  return usage_error(
      fmt::format("no such source of navigation '{}': must be mavlink:udp://:PORT, mavlink:udp://ADDRESS:PORT, "
                  "a50:tcp://HOST[:PORT], ros2:/TOPIC or ros2:/tf[:FRAME:FRAME]",
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
    if (lacks_port(host)) address += kA50Port;
    return LiveNav{LiveNav::Kind::kA50, address};
  }
  if (text.starts_with(kRos2Topic)) {
    return LiveNav{LiveNav::Kind::kRos2, text.substr(kRos2Topic.size() - 1)};
  }
  return no_such_navigation(text);
}

Take store_sector(HeadMotion& motion) {
  return [&motion](const std::string& text) -> Result<void> {
    const auto bearings = numbers_from<2>(text);
    if (!bearings) return tl::unexpected(bearings.error());
    if (!is_sector(*bearings)) {
      return usage_error(
          fmt::format("'{}': must be two bearings in degrees, the smaller one first, less than a turn apart", text));
    }
    motion.sector_deg = *bearings;
    return {};
  };
}

Take store_nav(std::vector<LiveNav>& targets) {
  return [&targets](const std::string& text) -> Result<void> {
    const Result<LiveNav> taken = navigation_from(text);
    if (!taken) return tl::unexpected(taken.error());
    targets.push_back(*taken);
    if (taken->kind == LiveNav::Kind::kRos2 && !taken->validate()) return no_such_navigation(text);
    return taken->kind == LiveNav::Kind::kA50 ? Link::check(taken->address) : Result<void>();
  };
}

/// "ros2:PREFIX", or "ros2".
Take store_publish(std::optional<Ros2Publish>& target) {
  return [&target](const std::string& text) -> Result<void> {
    constexpr std::string_view kRos2 = "ros2";
    const std::string rest = text.substr(std::min(kRos2.size(), text.size()));
    if (!text.starts_with(kRos2) || (!rest.empty() && !rest.starts_with(':'))) {
      return usage_error(fmt::format("must be ros2 or ros2:PREFIX, is '{}'", text));
    }
    Ros2Publish& options = target.emplace();
    // As ROS has names, or without the first slash.
    if (!rest.empty()) options.prefix = rest.substr(rest.starts_with(":/") ? 2 : 1);
    return options.validate();
  };
}

Take store_obstacles(std::optional<std::string>& target) {
  return [&target](const std::string& text) -> Result<void> {
    if (!text.starts_with("udp://")) return usage_error(fmt::format("must be udp://HOST:PORT, is '{}'", text));
    target = text;
    return Link::check(text);
  };
}

/// Without the options of logs, which are not there while a device runs.
OptionTable::Group without(OptionTable::Group group, std::initializer_list<std::string_view> names) {
  std::erase_if(group.options,
                [&](const Option& option) { return std::ranges::find(names, option.name) != names.end(); });
  return group;
}

/// Whether options are about the cells of a new map.
bool asks_for_cells(const MapOptions& map) {
  const MapOptions usual;
  return map.resolution_m || map.depth != usual.depth || map.clamp.lowest != usual.clamp.lowest ||
         map.clamp.highest != usual.clamp.highest;
}

Result<void> check_recording(const LiveArgs& args) {
  const LiveHead::Kind kind = args.live.head.kind;
  if (!args.record.empty()) {
    if (kind == LiveHead::Kind::kReplay) return usage_error("--record: a replay is already a recording");
    if (kind == LiveHead::Kind::kRos2) {
      return usage_error("--record: a topic of ROS 2 is not recorded: use 'ros2 bag record'");
    }
    for (const std::string_view suffix : {".tlog", ".jsonl"}) {
      if (!args.live.nav.empty() && args.record.ends_with(suffix)) {
        return usage_error(fmt::format("--record: {} is for --nav: give the sonar's log another suffix", suffix));
      }
    }
  }
  if (!args.live.nav.empty() && kind == LiveHead::Kind::kReplay) {
    return usage_error("--nav: live navigation does not fit the times of a replay; use 'pingvox map' with --nav");
  }
  return {};
}

Result<void> set_slam(const LiveArgs& args, LiveOptions& options) {
  if (args.slam == Slam::kNo) return {};
  options.slam.emplace().body_from_source = args.nav_mounts;
  if (args.known_map.empty()) return {};
  if (asks_for_cells(args.build.map)) {
    return usage_error("--resolution, --depth and --clamp: cells are those of --map");
  }
  options.known_map = LiveKnownMap{args.known_map, args.start};
  return {};
}

Result<void> set_publish(const LiveArgs& args, LiveOptions& options) {
  if (!options.publish) return {};
  options.publish->every_s = args.publish_every_s;
  if (options.map.depth == Lattice::kDefaultDepth) return {};
  return usage_error(
      fmt::format("--publish: messages hold maps of {} levels, not of {}", Lattice::kDefaultDepth, options.map.depth));
}

OptionTable::Group navigation_group(LiveArgs& args) {
  return {"Navigation",
          {{"--nav", 0, "NAV",
            "source of the vehicle's pose: mavlink:udp://:PORT or mavlink:udp://ADDRESS:PORT, what its autopilot sends "
            "by MAVLink to this port (at all addresses of this host, or at one), or a50:tcp://HOST[:PORT], the dead "
            "reckoning of a Water Linked DVL; recorded beside --record as .tlog or .jsonl; or ros2:/TOPIC, odometry, "
            "poses or a sensor's messages that a node of ROS 2 publishes, or ros2:/tf[:FRAME:FRAME], tf: the pose of "
            "base_link in the frame at the root, or that of the second frame in the first one",
            "the vehicle does not move", store_nav(args.live.nav), Repeats::kEachCounts},
           {"--obstacles", 0, "udp://HOST:PORT",
            "send the nearest obstacle in each of 72 sectors by MAVLink (OBSTACLE_DISTANCE), five times a second",
            "none", store_obstacles(args.live.obstacles)}}};
}

OptionTable::Group ros2_group(LiveArgs& args) {
  return {
      "ROS 2",
      {{"--publish", 0, "ros2[:PREFIX]",
        "publish the map when it has changed (octomap_binary, octomap_full, octomap_point_cloud_centers, "
        "projected_map), and each pose as odometry and tf, as topics of ROS 2, with PREFIX before all names but tf",
        "none", store_publish(args.live.publish)},
       only_with({{"--publish"}},
                 {"--publish-every", 0, "S", "least seconds from one published map to the next",
                  number_text(args.publish_every_s), within({0.1, 86'400.0}, store_number(args.publish_every_s))}),
       {"--ros-domain", 0, "N", "domain of the topics of ROS 2: ROS_DOMAIN_ID", std::to_string(args.live.ros2.domain),
        within({0.0, Ros2Network::kLastDomain}, store_number(args.live.ros2.domain))},
       {"--ros-interface", 0, "NAME",
        "network interface of the topics of ROS 2, as in eth0; lo: this host alone, without multicast",
        "by CYCLONEDDS_URI", store(args.live.ros2.interface)},
       choice("--ros-distribution", kDistributions,
              "distribution of the other nodes, so that they list pingvox as a node (later ones: rolling)",
              args.live.ros2.distribution, "topics alone are listed")}};
}

OptionTable::Group slam_group(LiveArgs& args) {
  Option nav_mount = nav_mount_option(args.nav_mounts);
  nav_mount.only_with = {{"--slam"}};
  Option start = start_option(args.start);
  start.only_with = {{"--map"}};
  return {"SLAM",
          {flag("--slam",
                "SLAM from the sonar and whatever velocity, heading and depth --nav has; the map is corrected at loop "
                "closures",
                args.slam, Slam::kYes),
           std::move(nav_mount),
           only_with(
               {{"--slam"}},
               {"--map", 0, "FILE",
                "known map, .bt, .ot or .pvx: the vehicle is located in it first, and the map is extended; -o has both",
                "a new map", store(args.known_map)}),
           std::move(start)}};
}

}  // namespace

Result<LiveHead> LiveArgs::head() const {
  LiveHead head = live.head;
  Ping360Settings& ping360 = head.ping360;
  MicronSettings& micron = head.micron;
  ping360.range_m = micron.range_m = range_m;
  micron.gain = ping360.gain;
  if (timeout_s) ping360.timeout_s = micron.timeout_s = *timeout_s;
  const bool is_micron = head.kind == LiveHead::Kind::kMicron;
  if (const auto valid = is_micron ? apply(motion, micron) : apply(motion, ping360); !valid) {
    return tl::unexpected(valid.error());
  }
  const Result<void> valid = is_micron ? micron.validate() : ping360.validate();
  if (!valid) return tl::unexpected(valid.error());
  return head;
}

Result<LiveOptions> LiveArgs::options() const {
  LiveOptions options = live;
  options.map = build.map;
  if (const auto valid = build.echoes.validate(); !valid) return tl::unexpected(valid.error());
  options.build = build.build_options();
  options.beam = build.head;
  if (const auto valid = options.map.validate(); !valid) return tl::unexpected(valid.error());
  if (const auto valid = check_options(options.build); !valid) return tl::unexpected(valid.error());
  Result<LiveHead> driven = head();
  if (!driven) return tl::unexpected(driven.error());
  options.head = *std::move(driven);
  if (const auto valid = check_recording(*this); !valid) return tl::unexpected(valid.error());
  if (!record.empty()) options.record = record;
  if (const auto valid = set_slam(*this, options); !valid) return tl::unexpected(valid.error());
  if (const auto valid = set_publish(*this, options); !valid) return tl::unexpected(valid.error());
  if (const auto valid = options.ros2.validate(); !valid) return tl::unexpected(valid.error());
  return options;
}

Take store_head(LiveHead& target) {
  return [&target](const std::string& text) -> Result<void> {
    const Result<LiveHead> taken = device_from(text);
    if (!taken) return tl::unexpected(taken.error());
    target.kind = taken->kind;
    target.address = taken->address;
    target.device = taken->device;
    target.speed = taken->speed;
    if (taken->kind == LiveHead::Kind::kReplay || taken->kind == LiveHead::Kind::kRos2) return {};
    if (const auto checked = Link::check(taken->address); !checked) return checked;
    return taken->validate();
  };
}

Result<void> check_limited(const std::vector<LimitedOption>& options, LiveHead::Kind kind) {
  return check_limited(options, {std::string(kind_of_device(kind))});
}

Option record_option(std::string& target) {
  return {"--record",
          0,
          "FILE",
          "record the bytes of the device: a Ping360's as a log of Ping Viewer, a Micron's as a capture of packets "
          "with their times; in a folder named by the time (a FILE without a suffix is one)",
          "none",
          store(target)};
}

OptionTable::Group head_group(LiveArgs& args) {
  OptionTable::Group group = {
      "Head",
      {{"--range", 0, "M",
        "range of a ping; where another program drives the head, only for the size of cells and obstacles",
        number_text(args.range_m), within(MicronSettings::kRanges_m, store_number(args.range_m))},
       {"--sector", 0, "FROM,TO", "sector to scan, in degrees from ahead, counter-clockwise", "full turns",
        store_sector(args.motion)},
       {"--step", 0, "DEG", "angle from beam to beam: a multiple of 0.9 (Ping360) or 0.05625 (Micron)",
        number_text(args.motion.step_deg), store_number(args.motion.step_deg)},
       choice("--gain", kGains, "gain of the receiver", args.live.head.ping360.gain),
       {"--timeout", 0, "S", "seconds to wait for an answer, including the turn of the head",
        fmt::format("{}, of a Micron {}", args.live.head.ping360.timeout_s, args.live.head.micron.timeout_s),
        within(kHeadTimeouts_s, store_optional(args.timeout_s))}}};
  for (Option& option : group.options) {
    option.only_for = {std::string(kHead)};
    if (option.name == "--range") option.only_for.emplace_back(kSharedHead);
  }
  return group;
}

std::vector<OptionTable::Group> live_groups(LiveArgs& args) {
  std::vector<OptionTable::Group> groups = {
      head_group(args),
      navigation_group(args),
      ros2_group(args),
      slam_group(args),
      map_group(args.build),
      without(sensor_group(args.build), {"--poses", "--nav", "--nav-source", "--nav-offset", "--use-calibration"}),
      without(echo_group(args.build.echoes, WaterOfNav::kNo), {"--background"})};
  for (OptionTable::Group& group : groups | std::views::drop(1)) {
    for (Option& option : group.options) {
      option.only_for.clear();  // there are no others than beams
      if (option.name == "--ray") option.only_with = {{"--beam", {"ray"}}};
    }
  }
  return groups;
}

}  // namespace pingvox::app
