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

/// What is known of a run beside LiveMapping.
struct LiveFigures {
  double latency_s = 0.0, beams_per_s = 0.0;
  double map_age_s = 0.0, beam_age_s = 0.0;                 ///< since the map has changed, and a beam has come
  std::optional<ObstacleSectors> obstacles = std::nullopt;  ///< nullopt: not known
};

/// Within the range of the head. nullopt: nobody knows where the vehicle is.
std::optional<ObstacleSectors> live_obstacles(const LiveMapping& live);

/// What the page shows of a run in figures: pose, obstacles, head, recording, counts (docs/view.md).
JsonObject live_status_json(const LiveMapping& live, const LiveStatus& status, const LiveFigures& figures,
                            MapAxes axes);

}  // namespace pingvox::web
