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

/// What MAVLink messages say of where a vehicle is and how it moves, one by one (docs/formats.md).
class MavlinkNav {
 public:
  /// System and component.
  using Sender = std::pair<std::uint8_t, std::uint8_t>;
  /// When a message was made, as its sender says.
  struct SinceBoot {
    Sender sender;
    std::size_t start;  ///< of its sender, counted from 0
    double since_s;
  };
  struct Report {
    std::string source;  ///< "ATTITUDE"; of others than the autopilot with their address: "DISTANCE_SENSOR 1/194"
    NavQuantity quantity = NavQuantity::kVelocity;
    NavSample sample;  ///< at the time when it was made, as far as that is known yet
    std::optional<SinceBoot> made = std::nullopt;
  };

  /// @param received_s  on the clock that times are wanted on
  std::vector<Report> add(const MavlinkFrame& frame, double received_s);

  /// When a message was made, on that clock, by all that came so far: the delay of messages varies, and the least one
  /// is the best estimate.
  double time_s(const SinceBoot& made) const { return starts_s_.at(made.sender)[made.start] + made.since_s; }

 private:
  std::map<Sender, std::vector<double>> starts_s_;  ///< when each sender was started
};

}  // namespace pingvox
