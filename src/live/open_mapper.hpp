#pragma once

#include <memory>

#include "live/beam_queue.hpp"
#include "pingvox/live/live_options.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/mapping/build_options.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// The resolution of the map of a run: as asked, else by the range of the pings; of a replay as `build_map` of its log
/// has it.
/// @param build  with the beam of the head
double resolution_of(const LiveOptions& options, const BuildOptions& build);

/// A mapper, and its map where it has none of its own.
struct MapperAndMap {
  BeamQueue::Mapper mapper;
  std::unique_ptr<OccupancyMap> map;
};

/// A mapper with an empty map, or one that goes on in the known map.
/// @param build        with the beam of the head
/// @param map_options  with a resolution
Result<MapperAndMap> open_mapper(const LiveOptions& options, const BuildOptions& build, const MapOptions& map_options);

}  // namespace pingvox
