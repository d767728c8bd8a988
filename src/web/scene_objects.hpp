#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>

#include "io/internal/json.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/map/map_axes.hpp"
#include "pingvox/web/scene.hpp"
#include "pingvox/web/scene_bytes.hpp"

/// Parts of a scene as the page reads them, also of one that grows.
namespace pingvox::web {

JsonObject log_json(const SceneLog& log, std::size_t id);
JsonObject axes_json(MapAxes axes);

/// Which poses of a growing path follow.
struct PartOfPath {
  std::uint32_t version = 0;  ///< changes when poses that were sent have changed
  std::uint32_t first = 0;    ///< number of the first one
};
Bytes pose_bytes(std::span<const StampedPose> poses, const Eigen::Vector3d& origin_m, const PartOfPath& part_of_path);
/// @param first  number of the log's first beam
Bytes beams_bytes(const SceneLog& log, std::uint32_t first);

}  // namespace pingvox::web
