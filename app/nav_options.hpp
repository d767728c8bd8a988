#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "option_table.hpp"
#include "option_values.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/nav/main_source.hpp"

/// Options that say where the vehicle was, and where its sensors are on it.
namespace pingvox::app {

/// --mount: "x,y,z,roll,pitch,yaw", metres and degrees, as a pose.
Option mount_option(Pose& target);
/// The same, and whether it was given.
Option mount_option(Pose& target, bool& is_given);
/// "x,y,z,roll,pitch,yaw", metres and degrees.
Take store_mount(Pose& target);
/// "NAME=x,y,z,roll,pitch,yaw", once for each.
/// @param name  of what, for the error: "SOURCE"
Take store_pose_of(std::map<std::string, Pose>& target, std::string name);
/// --nav: navigation logs.
Option nav_option(Args& targets, std::string help);
/// --nav-source, without the condition that there is --nav.
Option source_option(std::vector<NamedSource>& targets);
/// What has an effect only with --nav: the sources to use, seconds to add to its times, mounts of its sources, and the
/// output of 'slam --calibration'.
Option nav_source_option(std::vector<NamedSource>& targets);
Option nav_offset_option(std::optional<double>& target_s);
Option nav_mount_option(std::map<std::string, Pose>& body_from_source);
Option use_calibration_option(std::string& target, std::string help);

}  // namespace pingvox::app
