#pragma once

#include <string_view>

namespace pingvox::app {

/// The kinds of input that options may be limited to (Option::only_for).
inline constexpr std::string_view kBeamLogs = "logs of beams", kPointLogs = "point scans", kClouds = "clouds of points",
                                  kNavLogs = "navigation logs", kMaps = "maps", kMeshes = "meshes",
                                  kBagScans = "scans in ROS bags", kEchoTables = "tables of echoes (--echoes)",
                                  kRayBeams = "beams as rays (--beam ray)", kMadeMaps = "logs that are mapped";

}  // namespace pingvox::app
