#pragma once

#include <span>
#include <string>

#include "drives/drive.hpp"
#include "pingvox/result.hpp"
#include "pingvox/viewer/render_map.hpp"

namespace pingvox::bench {

/// The maps of a drive along several trajectories, side by side, each with its trajectory and the reference, turned and
/// shifted onto it, as `file` into a folder, which is created if missing.
Result<void> draw_drive(const Drive& drive, std::span<const MapPath> trajectories, const std::string& folder,
                        const std::string& file);

}  // namespace pingvox::bench
