#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pingvox/io/mavlink.hpp"
#include "pingvox/nav/nav_log.hpp"

namespace pingvox {

/// Converts MAVLink messages to navigation samples (docs/formats.md).
class MavlinkNav {
 public:
  /// System and component.
  using Sender = std::pair<std::uint8_t, std::uint8_t>;
  /// Time at which a message was made, on the clock of its sender.
  struct SinceBoot {
    Sender sender;
    std::size_t start;  ///< of its sender, counted from 0
    double since_s;
  };
  struct Report {
    std::string source;  ///< "ATTITUDE"; of others than the autopilot with their address: "DISTANCE_SENSOR 1/194"
    NavQuantity quantity = NavQuantity::kVelocity;
    NavSample sample;  ///< at the time when it was made, as well as known yet
    std::optional<SinceBoot> made = std::nullopt;
  };

  /// @param received_s  on the clock that times are wanted on
  std::vector<Report> add(const MavlinkFrame& frame, double received_s);

  /// Time at which a message was made, on that clock, by all messages so far: their delay varies, and the smallest one
  /// is the best estimate.
  double time_s(const SinceBoot& made) const { return starts_s_.at(made.sender)[made.start] + made.since_s; }

 private:
  std::map<Sender, std::vector<double>> starts_s_;  ///< when each sender was started
};

}  // namespace pingvox
