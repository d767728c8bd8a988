#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "pingvox/device/link.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/mapping/obstacle_sectors.hpp"
#include "pingvox/result.hpp"

namespace pingvox::app {

/// Sends the nearest obstacles to an autopilot, five times a second.
class ObstacleSender {
 public:
  static Result<ObstacleSender> open(const std::string& address, const ObstacleOptions& options);

  double due_s() const { return due_s_; }

  /// @param map_from_body  nullopt: not known, and nothing is sent
  void send(const OccupancyMap& map, const std::optional<Pose>& map_from_body, double now_s);

 private:
  ObstacleSender(Link link, const ObstacleOptions& options) : link_(std::move(link)), options_(options) {}

  Link link_;
  ObstacleOptions options_;
  double due_s_ = 0.0;
  std::uint8_t sequence_ = 0;
};

}  // namespace pingvox::app
