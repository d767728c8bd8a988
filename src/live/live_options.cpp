#include "pingvox/live/live_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "base/option_errors.hpp"
#include "device/internal/link.hpp"
#include "device/internal/ros2_nav_receiver.hpp"
#include "device/internal/ros2_node.hpp"

namespace pingvox {

std::string LiveHead::name() const {
  switch (kind) {
    case Kind::kPing360:
      return "ping360:" + address;
    case Kind::kMicron:
      return "micron:" + address;
    case Kind::kSharedPing360:
      return "ping360-listen:" + address;
    case Kind::kPingViewer2:
      return fmt::format("pingviewer2:{}{}{}", address.substr(address.find("://") + 3), device.empty() ? "" : "/",
                         device);
    case Kind::kRos2:
      return "ros2:" + address;
    case Kind::kReplay:
      break;
  }
  return "replay:" + address;
}

Result<void> LiveHead::validate() const {
  OptionErrors errors;
  if (kind == Kind::kReplay) {
    errors.require(speed > 0.0, "speed", "> 0", speed);
    errors.require(!address.empty(), "address", "a file", "empty");
  } else if (kind == Kind::kRos2) {
    errors.require(is_ros2_topic(address), "address", "the name of a topic of ROS 2, as /scan_echo", address);
    errors.add(ping360.validate());
  } else {
    errors.add(Link::check(address));
    if (kind == Kind::kSharedPing360)
      errors.require(address.starts_with("udp://"), "address", "udp://HOST:PORT", address);
    if (kind == Kind::kPingViewer2) {
      errors.require(address.starts_with("tcp://"), "address", "tcp://HOST:PORT", address);
      const bool is_number = device.find_first_not_of("0123456789abcdefABCDEF-") == std::string::npos;
      errors.require(is_number, "device", "hexadecimal digits and dashes", device);
    }
    errors.add(kind == Kind::kMicron ? micron.validate() : ping360.validate());
  }
  return errors.result("head");
}

Result<void> LiveNav::validate() const {
  OptionErrors errors;
  if (kind == Kind::kA50) {
    errors.require(address.starts_with("tcp://"), "address", "tcp://HOST:PORT", address);
    if (address.starts_with("tcp://")) errors.add(Link::check(address));
  } else if (kind == Kind::kRos2) {
    errors.require(Ros2NavAddress::parse(address).has_value(), "address",
                   "the name of a topic of ROS 2, as /odom, or of tf followed by two frames, as /tf:map:base_link",
                   address);
  } else {
    errors.require(address.starts_with("udp://"), "address", "udp://:PORT or udp://ADDRESS:PORT", address);
  }
  return errors.result("nav");
}

bool LiveOptions::uses_ros2() const {
  return publish || head.kind == LiveHead::Kind::kRos2 ||
         std::ranges::any_of(nav, [](const LiveNav& device) { return device.kind == LiveNav::Kind::kRos2; });
}

Result<void> LiveOptions::validate() const {
  OptionErrors errors;
  errors.add(head.validate());
  for (const LiveNav& device : nav) errors.add(device.validate());
  if (head.kind == LiveHead::Kind::kReplay) {
    if (record) errors.add("record: a replay is already a recording");
    if (!nav.empty()) errors.add("nav: live navigation does not fit the times of a replay");
  }
  if (head.kind == LiveHead::Kind::kRos2 && record) errors.add("record: a topic of ROS 2 is not recorded");
  for (const std::string_view suffix : {".tlog", ".jsonl"}) {
    if (record && !nav.empty() && record->ends_with(suffix)) {
      errors.add(fmt::format("record: {} is the suffix of a recording of navigation", suffix));
    }
  }
  if (obstacles) {
    errors.require(obstacles->starts_with("udp://"), "obstacles", "udp://HOST:PORT", *obstacles);
    if (obstacles->starts_with("udp://")) errors.add(Link::check(*obstacles));
  }
  if (uses_ros2()) errors.add(ros2.validate());
  if (publish) {
    errors.add(publish->validate());
    const std::string odometry = publish->topic("/odometry");
    const auto is_own = [&](const LiveNav& device) {
      return device.kind == LiveNav::Kind::kRos2 && device.address == odometry;
    };
    if (std::ranges::any_of(nav, is_own)) {
      errors.add(fmt::format("nav: {} is what is published by pingvox itself: publish with a prefix", odometry));
    }
    if (map.depth != Lattice::kDefaultDepth) {
      errors.add(fmt::format("publish: messages hold maps of {} levels, not of {}", Lattice::kDefaultDepth, map.depth));
    }
  }
  if (slam) errors.add(slam->validate());
  if (known_map) {
    if (!slam) errors.add("known_map: only with slam");
    errors.require(!known_map->file.empty(), "known_map", "a file", "empty");
    if (const std::optional<StartPose>& start = known_map->start) {
      const bool is_finite = std::isfinite(start->x_m) && std::isfinite(start->y_m) && std::isfinite(start->yaw_rad);
      if (!is_finite) errors.add("start must be finite");
      errors.require_within("deviation_m", start->deviation_m, 0.0, 1e6);
      errors.require_within("deviation_rad", start->deviation_rad, 0.0, 1e3);
    }
  }
  errors.add(map.validate());
  errors.add(build.validate());
  return errors.result("live");
}

}  // namespace pingvox
