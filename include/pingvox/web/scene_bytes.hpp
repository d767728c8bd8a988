#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"
#include "pingvox/web/scene.hpp"

/// A scene as the page reads it (docs/view.md): one JSON object, and columns of numbers, little-endian and aligned to
/// four bytes.
namespace pingvox::web {

using Bytes = std::vector<std::uint8_t>;

/// Most cells and free leaves of a map that are sent.
inline constexpr std::size_t kMaxCells = std::size_t{1} << 26, kMaxFreeLeaves = std::size_t{1} << 25;

/// The contents of a scene, with the paths of its data.
std::string scene_json(const Scene& scene);

/// The cells of a map that may be occupied: bricks of 4 x 4 x 4 cells with masks, and probabilities.
/// @return kLimit for more than kMaxCells, or cells more than 2^31 cells from the origin
Result<Bytes> cells_bytes(const OccupancyMap& map);
/// How well echoes agree with these cells: a byte for each, in their order (CellAgreement::level). Errors likewise.
Result<Bytes> agreement_bytes(const SceneMap& map);
/// The free leaves of a map as cubes. Errors likewise.
Result<Bytes> free_bytes(const OccupancyMap& map);

Bytes path_bytes(const ScenePath& path, const Eigen::Vector3d& origin_m);
Bytes points_bytes(const ScenePoints& points, const Eigen::Vector3d& origin_m);
/// The beams of a log, without their intensities.
Bytes beams_bytes(const SceneLog& log);

}  // namespace pingvox::web
