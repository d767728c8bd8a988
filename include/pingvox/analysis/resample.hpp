#pragma once

#include <cstdint>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// The most cells of the finest resolution that `resample` writes.
inline constexpr std::uint64_t kMaxResampledCells = std::uint64_t{1} << 30;
/// The deepest lattice that `resample` reads and writes.
inline constexpr int kMaxResampledDepth = 62;

/// A map moved into another frame and written in other cells. No wall gets lost: the middle of each cell that is not
/// free lies in a cell of the result that is not free, or beside one. Nothing becomes free that was not: a cell of the
/// result is free only where all cells that it overlaps are free, with the greatest of their log-odds. Of several that
/// are not free it also has the greatest log-odds.
/// @param to_from_map  the frame of the result from that of the map
/// @param to           resolution, depth, clamp, thresholds and rule for parents of the result; free and occupied are
///                     classified by the thresholds of `map`
/// @return kBadOption when `to` does not validate; kUnsupported for lattices deeper than kMaxResampledDepth; kLimit
///         when known cells reach out of the other lattice, or there are more than kMaxResampledCells; kNoMemory
Result<OccupancyMap> resample(const OccupancyMap& map, const Pose& to_from_map, const MapOptions& to);

/// Adds another map to a map, log-odds to log-odds and clamped: as it is where the cells are the same, else by
/// `resample`.
/// @return as resample and OccupancyMap::merge; the map is as before then
Result<void> add_map(const OccupancyMap& other, const Pose& into_from_other, OccupancyMap& into);

}  // namespace pingvox
