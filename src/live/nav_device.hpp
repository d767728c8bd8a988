#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "device/internal/a50_receiver.hpp"
#include "device/internal/mavlink_receiver.hpp"
#include "device/internal/ros2_nav_receiver.hpp"
#include "live/recordings.hpp"
#include "pingvox/live/live_mapping.hpp"
#include "pingvox/live/live_options.hpp"
#include "pingvox/nav/device_clock.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// An autopilot, a DVL or a topic of ROS 2 that reports the pose of the vehicle.
class NavDevice {
 public:
  /// @param record        name of the record, less its suffix; nullopt: nothing is recorded
  /// @param since_1970_s  time of the recording at 0 of the clock that `read` is told
  /// @param node          for topics of ROS 2
  static Result<NavDevice> open(const LiveNav& from, std::optional<std::filesystem::path> record,
                                Recordings& recordings, double since_1970_s, const std::optional<Ros2Node>& node);

  /// Ends the recording, and begins another one.
  /// @param record  as for `open`
  Result<void> record(std::optional<std::filesystem::path> record, Recordings& recordings);
  LiveNav::Kind kind() const;

  /// "mavlink:udp://127.0.0.1:14550", with the port that was chosen.
  std::string name() const;
  int descriptor() const;  ///< for poll()
  /// Whether it reads the vehicle's pose from tf.
  bool reads_tf() const;
  LiveNavStatus status() const;

  /// Whether the sender of these positions has restarted: they are relative to another origin since then.
  bool has_other_origin(const std::string& position) const;

  /// Takes a sample of a source.
  using Take = std::function<void(const std::string& source, NavQuantity, const NavSample&)>;
  /// Hands on the samples that have arrived. @param now_s  on the beams' clock
  Result<void> read(double now_s, const Take& take);

 private:
  using Receiver = std::variant<MavlinkReceiver, A50Receiver, Ros2NavReceiver>;
  explicit NavDevice(Receiver receiver) : receiver_(std::move(receiver)) {}
  void note_start(const MavlinkNav::Report& report);

  Receiver receiver_;
  struct Positions {
    DeviceTime last;  ///< when it was made
    bool has_other_origin = false;
  };
  std::map<std::string, Positions> positions_;  ///< of each source
};

}  // namespace pingvox
