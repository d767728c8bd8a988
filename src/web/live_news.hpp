#pragma once

#include <atomic>
#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "io/internal/json.hpp"
#include "mapping/internal/obstacle_sectors.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/live/live_mapping.hpp"
#include "pingvox/map/map_axes.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/sonar/beam.hpp"
#include "web/live_cells.hpp"

namespace pingvox::web {

/// What the loop of a run hands over to those that show it.
struct LiveNews {
  CellChanges cells;
  std::vector<Beam> beams;
  std::optional<std::vector<StampedPose>> path;  ///< all of it, corrected
  std::optional<StampedPose> pose;
  std::optional<OccupancyMap> map;  ///< a copy, where free cells are asked for
  JsonObject status;
};

/// Gathers what is new in a run, in the thread of its loop.
class NewsGatherer {
 public:
  explicit NewsGatherer(MapAxes axes) : axes_(axes) {}

  /// Notes the latency of a beam. The longest one is told with the next news.
  void note_latency(double latency_s);
  /// Notes a sentence about what has happened; the last ones are told.
  void tell(std::string message);
  /// The next news have all cells: what was gathered before may be lost.
  void ask_for_all() { is_lost_ = true; }

  /// What is new since the last time.
  /// @param wants_free  whether a copy of the map is asked for; set to false where there is one
  LiveNews gather(LiveMapping& live, double now_s, std::atomic<bool>& wants_free);

 private:
  void note_rate(std::size_t beams, double now_s);

  MapAxes axes_;
  double latency_s_ = 0.0, beams_per_s_ = 0.0, rated_s_ = 0.0, mapped_s_ = 0.0, beam_s_ = 0.0;
  std::size_t rated_beams_ = 0, mapped_ = 0, corrections_ = 0, told_ = 0;
  std::optional<ObstacleSectors> obstacles_;
  double obstacles_due_s_ = 0.0, free_due_s_ = 0.0;
  std::deque<std::string> messages_;
  bool is_lost_ = true, has_failed_ = false;
};

}  // namespace pingvox::web
