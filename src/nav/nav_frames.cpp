#include "nav/internal/nav_frames.hpp"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "pingvox/geometry/pose.hpp"

namespace pingvox {
namespace {

/// Calls `use` with each part of a name between '/', '_', '-' and '.', in lower case.
template <class Use>
void for_each_part(std::string_view name, Use use) {
  std::string part;
  for (const char c : name) {
    if (c != '/' && c != '_' && c != '-' && c != '.') {
      part += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else {
      use(std::string_view(part));
      part.clear();
    }
  }
  use(std::string_view(part));
}

/// Without the names before the last '/': those of one of several vehicles.
std::string_view own_name(std::string_view frame) {
  while (frame.ends_with('/')) frame.remove_suffix(1);
  return frame.substr(frame.rfind('/') + 1);  // npos + 1 is 0
}

bool has_part(std::string_view name, std::span<const std::string_view> parts) {
  bool has = false;
  for_each_part(name, [&](std::string_view part) { has = has || std::ranges::find(parts, part) != parts.end(); });
  return has;
}

constexpr auto kOnVehicle = std::to_array<std::string_view>(
    {"base", "body", "vehicle", "robot", "link", "camera", "cam", "optical", "imu", "sonar", "dvl", "sensor"});

bool is_pose(const NavSource& source) {
  return source.quantity == NavQuantity::kPosition || source.quantity == NavQuantity::kAttitude ||
         source.quantity == NavQuantity::kHeading;
}

/// How the axes of a pose point, as resolved.
struct PoseAxes {
  bool is_world_down = false, is_body_down = false;
  bool is_contradiction = false;
  std::string note;
};

/// Whether z of the body points along z of the frame in most samples.
bool is_mostly_along(const NavSource& attitude) {
  const auto along = std::ranges::count_if(attitude.samples, [](const NavSample& sample) {
    return std::cos(sample.value.x()) * std::cos(sample.value.y()) > 0.0;
  });
  return 2 * along >= static_cast<std::ptrdiff_t>(attitude.samples.size());
}

constexpr std::string_view kNed = "north, east, down", kFrd = "forward, right, down";

/// @param attitude  of the same name; nullptr: there is none
PoseAxes axes_of_pose(const std::string& frame, const std::string& child, const NavSource* attitude) {
  const FrameAxes world = axes_of(frame), body = axes_of(child);
  PoseAxes axes{world == FrameAxes::kDown, body == FrameAxes::kDown, false, {}};
  const bool is_upright_if_alike = attitude == nullptr || is_mostly_along(*attitude);
  if (axes.is_world_down && body == FrameAxes::kNotNamed) axes.is_body_down = is_upright_if_alike;
  if (axes.is_body_down && frame.empty()) axes.is_world_down = is_upright_if_alike;
  if (axes.is_world_down) {
    axes.note = fmt::format("turned from {} ({}) and {}{}", frame.empty() ? child : frame, kNed,
                            child.empty() ? "its body" : child, axes.is_body_down ? fmt::format(" ({})", kFrd) : "");
  } else if (axes.is_body_down) {
    axes.note = fmt::format("turned from {} ({})", child, kFrd);
    axes.is_contradiction =
        !frame.empty() && world == FrameAxes::kNotNamed && attitude != nullptr && is_upright_if_alike;
    if (axes.is_contradiction) {
      axes.note = fmt::format("{} ({}) would lie on its back in {}: one of the two names is wrong", child, kFrd, frame);
    }
  }
  return axes;
}

Eigen::Vector3d turned_attitude(const Eigen::Vector3d& rpy, const PoseAxes& axes) {
  if (axes.is_world_down && axes.is_body_down) return from_ned::attitude(rpy);
  Eigen::Matrix3d ours_from_ned;
  ours_from_ned << 0, 1, 0, 1, 0, 0, 0, 0, -1;
  Eigen::Matrix3d rotation = pose_from_rpy(Eigen::Vector3d::Zero(), rpy.x(), rpy.y(), rpy.z()).rotation();
  if (axes.is_world_down) rotation = ours_from_ned * rotation;
  if (axes.is_body_down) rotation = rotation * Eigen::Vector3d(1, -1, -1).asDiagonal();
  return rpy_of(rotation);
}

void turn_pose(NavSource& source, const PoseAxes& axes) {
  source.note += (source.note.empty() ? "" : ", ") + axes.note;
  if (axes.is_contradiction) source.subject = NavSubject::kOther;
  for (NavSample& sample : source.samples) {
    if (source.quantity == NavQuantity::kAttitude) {
      sample.value = turned_attitude(sample.value, axes);
    } else if (axes.is_world_down && source.quantity == NavQuantity::kPosition) {
      sample.value = from_ned::world(sample.value);
      std::swap(sample.deviation.x(), sample.deviation.y());
    } else if (axes.is_world_down && source.quantity == NavQuantity::kHeading) {
      sample.value.x() = from_ned::yaw(sample.value.x());
    }
  }
}

/// @param pose  axes of the pose of the same name, if it has one
void turn_motion(NavSource& source, const PoseAxes* pose, std::string_view child) {
  const bool is_of_pose = pose != nullptr && !source.frame.empty() && source.frame == child;
  const bool is_of_body = is_of_pose || is_of_vehicle(source.subject) || !is_fixed_frame(source.frame);
  if (!is_of_body) return;
  const bool is_down = is_of_pose ? pose->is_body_down : axes_of(source.frame) == FrameAxes::kDown;
  if (!is_down) return;
  source.note = fmt::format("turned from {} ({})", source.frame, kFrd);
  for (NavSample& sample : source.samples) sample.value = from_ned::body(sample.value);
}

}  // namespace

FrameAxes axes_of(std::string_view frame) {
  FrameAxes axes = FrameAxes::kNotNamed;
  for_each_part(own_name(frame), [&](std::string_view part) {
    if (part == "ned" || part == "frd") axes = FrameAxes::kDown;
    if (part == "enu" || part == "flu") axes = FrameAxes::kUp;
    if (part == "optical") axes = FrameAxes::kOptical;
  });
  return axes;
}

bool has_north(const NavSource& position) {
  constexpr auto kNorth = std::to_array<std::string_view>({"ned", "enu"});
  return position.frame.empty() || has_part(own_name(position.frame), kNorth);
}

Eigen::Matrix3d ours_from_optical() {
  Eigen::Matrix3d turn;
  turn << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return turn;
}

bool is_fixed_frame(std::string_view frame) {
  constexpr auto kFixed = std::to_array<std::string_view>(
      {"map", "odom", "odometry", "world", "earth", "utm", "local", "global", "origin", "inertial"});
  constexpr auto kAxes = std::to_array<std::string_view>({"ned", "enu"});
  const std::string_view name = own_name(frame);
  return has_part(name, kFixed) || (has_part(name, kAxes) && !has_part(name, kOnVehicle));
}

bool is_on_vehicle(std::string_view frame) {
  return !is_fixed_frame(frame) && has_part(own_name(frame), kOnVehicle);
}

bool is_vehicle_frame(std::string_view frame) {
  constexpr auto kParts = std::to_array<std::string_view>({"base", "body", "vehicle", "robot", "rov", "auv"});
  return !is_fixed_frame(frame) && has_part(own_name(frame), kParts);
}

bool is_base_link(std::string_view frame) {
  constexpr auto kBase = std::to_array<std::string_view>({"base"}), kLink = std::to_array<std::string_view>({"link"});
  return has_part(own_name(frame), kBase) && has_part(own_name(frame), kLink);
}

std::string reason_against_frames(const NavSource& source) {
  const bool is_motion = source.quantity == NavQuantity::kVelocity || source.quantity == NavQuantity::kTurnRate;
  if (source.subject != NavSubject::kUncertain) {
    if (is_motion || !is_on_vehicle(source.frame) || !is_fixed_frame(source.child)) return "";
    return fmt::format("{} moves with the vehicle and {} does not: it is the inverse of a pose of the vehicle",
                       source.frame, source.child);
  }
  if (is_motion) return is_fixed_frame(source.frame) ? "in the axes of " + source.frame + ", not of the vehicle" : "";
  return is_on_vehicle(source.frame) ? source.frame + " moves with the vehicle" : "";
}

void turn_frames(std::vector<NavSource>& sources) {
  std::map<std::string, std::vector<NavSource*>> by_name;
  for (NavSource& source : sources) {
    const bool may_turn = axes_of(source.frame) == FrameAxes::kDown || axes_of(source.child) == FrameAxes::kDown;
    if (may_turn || !source.child.empty() || !source.frame.empty()) by_name[source.name].push_back(&source);
  }
  for (const auto& [name, all] : by_name) {
    const auto pose = std::ranges::find_if(all, [](const NavSource* source) { return is_pose(*source); });
    const auto attitude = std::ranges::find(all, NavQuantity::kAttitude, &NavSource::quantity);
    std::optional<PoseAxes> axes;
    std::string child;
    if (pose != all.end()) {
      axes = axes_of_pose((*pose)->frame, (*pose)->child, attitude == all.end() ? nullptr : *attitude);
      child = (*pose)->child;
    }
    const bool turns_pose = axes && (axes->is_world_down || axes->is_body_down);
    for (NavSource* source : all) {
      if (!is_pose(*source)) {
        turn_motion(*source, axes ? &*axes : nullptr, child);
      } else if (turns_pose) {
        turn_pose(*source, *axes);
      }
    }
  }
}

}  // namespace pingvox
