#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "pingvox/nav/nav_log.hpp"

// What the names of ROS frames say (REP-103, REP-105): "world_ned", "base_link_frd", "bluerov2/odom", "camera_optical".
namespace pingvox {

/// Frame of the dead reckoning of a device: it begins at 0, x right and y ahead of the vehicle as it was then.
inline constexpr std::string_view kStartFrame = "local_start";
/// Whether x of a position is east and y north: its frame says so, or it is not named, which stands for the frame of
/// NavQuantity::kPosition.
bool has_north(const NavSource& position);

/// How the axes of a frame point, by its name.
enum class FrameAxes {
  kNotNamed,  ///< as ROS has them by default: x east or ahead, y north or left, z up
  kUp,        ///< the same by name: "_enu", "_flu"
  kDown,      ///< "_ned": x north or forward, y east or right, z down; "_frd": forward, right, down
  kOptical    ///< "_optical": x right, y down, z ahead
};
FrameAxes axes_of(std::string_view frame);

/// From the axes of an optical frame to ours.
Eigen::Matrix3d ours_from_optical();

/// Whether a frame stands still while the vehicle moves: "map", "odom", "world", "local_ned".
bool is_fixed_frame(std::string_view frame);

/// Whether a frame that is not fixed is a part of the vehicle by its name: "base_link", "camera_optical".
bool is_on_vehicle(std::string_view frame);

/// Whether a frame is the vehicle's own: "base_link", "base_footprint", "body"; and whether it is named base_link.
bool is_vehicle_frame(std::string_view frame);
bool is_base_link(std::string_view frame);

/// Why a source is not the vehicle's by the names of its frames: a pose of something in a frame that moves with the
/// vehicle, a velocity of something in the axes of one that stands still, an inverted pose of the vehicle (that of
/// "odom" in "base_link"). Empty: it may be.
std::string reason_against_frames(const NavSource& source);

/// Turns the values of sources whose frames are named as north-east-down or forward-right-down into our frames, and
/// notes it. Position, attitude, velocity and turn rate of one name are turned alike. Where the frame of a pose is
/// north-east-down and the name of its child does not say how its axes point (or the other way round, in an Imu), they
/// are those in which the vehicle is mostly upright. A child that is forward-right-down in a frame that is x east,
/// y north, z up has to be mostly upright as well: otherwise the two names contradict each other, and the sources
/// become NavSubject::kOther.
void turn_frames(std::vector<NavSource>& sources);

}  // namespace pingvox
