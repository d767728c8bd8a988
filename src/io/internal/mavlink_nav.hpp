#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/internal/mavlink.hpp"
#include "pingvox/nav/device_clock.hpp"
#include "pingvox/nav/nav_log.hpp"

namespace pingvox {

/// Converts MAVLink messages to navigation samples (docs/formats.md).
class MavlinkNav {
 public:
  /// System and component.
  using Sender = std::pair<std::uint8_t, std::uint8_t>;
  /// When a message was made, by the clock of its sender, which is 0 when that is started.
  struct Made {
    Sender sender;
    DeviceTime time;
  };
  struct Report {
    std::string source;  ///< "ATTITUDE"; of others than the autopilot with their address: "DISTANCE_SENSOR 1/194"
    NavQuantity quantity = NavQuantity::kVelocity;
    NavSample sample;  ///< at the time when it was made, as well as known yet
    std::optional<Made> made = std::nullopt;
  };

  /// Whether a frame has navigation of a vehicle: its message is one that `add` converts, and its sender is no
  /// ground station (system 250 to 255). Extensions of companion computers send as ground stations do, so messages of
  /// those are converted too, as being of the vehicle that they are received with.
  static bool is_of_vehicle(const MavlinkFrame& frame);
  static bool is_ground_station(const MavlinkFrame& frame);

  /// @param received_s  on the clock that times are wanted on
  std::vector<Report> add(const MavlinkFrame& frame, double received_s);

 private:
  std::map<Sender, DeviceClock> clocks_;
};

}  // namespace pingvox
