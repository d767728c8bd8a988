#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "commands.hpp"
#include "option_table.hpp"
#include "pingvox/map/map_axes.hpp"
#include "pingvox/result.hpp"

/// Where maps and paths are on the earth.
namespace pingvox::app {

/// "LAT,LON" in degrees -> a fix, as NavQuantity::kFix has it, at altitude 0.
Take store_origin(std::optional<Eigen::Vector3d>& target);

/// The fix at 0, 0 of a map; nullopt: no origin is asked for.
/// @param command  of the navigation: damage, fields and chosen sources
/// @return kBadOption when the map's axes are not east and north; kUnsupported when the navigation has no fix; errors
/// of
///         reading it
Result<std::optional<Eigen::Vector3d>> origin_fix_of(const ConvertCommand& command, MapAxes axes);

/// "; 0, 0 at latitude 54.5000000, longitude 10.2500000 degrees", or that it is not placed.
std::string place_text(const std::optional<Eigen::Vector3d>& origin_fix, MapAxes axes);

/// The .prj beside a grid.
std::string prj_file(const std::string& output);
/// The .pgw beside a PNG.
std::string world_file(const std::string& output);

}  // namespace pingvox::app
