#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "device/internal/link.hpp"
#include "mapping/internal/obstacle_sectors.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Sends the nearest obstacles to an autopilot, five times a second.
class ObstacleSender {
 public:
  /// @param address  of a host, which is looked up in the background
  ObstacleSender(const std::string& address, const ObstacleOptions& options);

  double due_s() const { return due_s_; }
  void set(const ObstacleOptions& options) { options_ = options; }

  /// @param map_from_body  nullopt: not known, and nothing is sent
  void send(const OccupancyMap& map, const std::optional<Pose>& map_from_body, double now_s);

  /// Why nothing can be sent; empty: no problem is known.
  const std::string& problem() const { return problem_; }

 private:
  void open(double now_s);

  std::string address_;
  std::optional<LinkOpening> opening_;
  std::optional<Link> link_;
  std::string problem_;
  double open_at_s_ = 0.0;  ///< where the last try has failed
  ObstacleOptions options_;
  double due_s_ = 0.0;
  std::uint8_t sequence_ = 0;
};

}  // namespace pingvox
