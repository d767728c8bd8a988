#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>

#include "io/internal/json.hpp"
#include "mapping/internal/obstacle_sectors.hpp"
#include "pingvox/live/live_mapping.hpp"
#include "pingvox/map/map_axes.hpp"

namespace pingvox::web {

/// Figures of a run that LiveMapping does not keep.
struct LiveFigures {
  double latency_s = 0.0, beams_per_s = 0.0;
  double map_age_s = 0.0, beam_age_s = 0.0;                 ///< since the last change of the map, and the last beam
  std::optional<ObstacleSectors> obstacles = std::nullopt;  ///< nullopt: unknown
};

/// Within the range of the head. nullopt: the pose is unknown.
std::optional<ObstacleSectors> live_obstacles(const LiveMapping& live);

/// The figures of a run on the page: pose, obstacles, head, recording, counts (docs/view.md).
JsonObject live_status_json(const LiveMapping& live, const LiveStatus& status, const LiveFigures& figures,
                            MapAxes axes);

}  // namespace pingvox::web
