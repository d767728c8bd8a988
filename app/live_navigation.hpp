#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "commands.hpp"
#include "device/internal/a50_receiver.hpp"
#include "device/internal/mavlink_receiver.hpp"
#include "pingvox/nav/device_clock.hpp"
#include "pingvox/nav/live_poses.hpp"
#include "pingvox/result.hpp"
#include "recordings.hpp"

namespace pingvox::app {

/// An autopilot or a DVL that reports the pose of the vehicle.
class NavDevice {
 public:
  struct Status {
    std::size_t messages = 0, damaged = 0;
    bool is_connected = true;  ///< as far as it can be told
    std::size_t connections = 0;
    std::string problem;  ///< why not
    std::optional<Error> recording_error;
    /// Of one that listens, as those of MavlinkReceiver::Status.
    std::string vehicle = {};
    std::size_t vehicles = 0, ignored = 0;
    std::vector<std::string> others = {};
  };

  /// @param record        name of the record, less its suffix; nullopt: nothing is recorded
  /// @param since_1970_s  time of the recording at 0 of the clock that `read` is told
  static Result<NavDevice> open(const LiveNavigation& from, std::optional<std::filesystem::path> record,
                                Recordings& recordings, double since_1970_s);

  /// As --nav has it, with the port that was chosen.
  std::string name() const;
  /// It waits for others to send to it, and does not know who they are.
  bool listens() const { return std::holds_alternative<MavlinkReceiver>(receiver_); }
  int descriptor() const;  ///< for poll()
  Status status() const;

  /// Whether the sender of these positions was started anew: they are relative to another origin since then.
  bool has_other_origin(const std::string& position) const;

  /// Adds the samples that have arrived. @param now_s  on the beams' clock
  Result<void> read(double now_s, LivePoses& poses);

 private:
  using Receiver = std::variant<MavlinkReceiver, A50Receiver>;
  explicit NavDevice(Receiver receiver) : receiver_(std::move(receiver)) {}
  void note_start(const MavlinkNav::Report& report);

  Receiver receiver_;
  struct Positions {
    DeviceTime last;  ///< when it was made
    bool has_other_origin = false;
  };
  std::map<std::string, Positions> positions_;  ///< of each source
};

/// Pose of the vehicle by all navigation devices.
class Navigation {
 public:
  /// @param start_s       when the beams' clock was 0
  /// @param since_1970_s  the same as a date
  static Result<Navigation> open(const std::vector<LiveNavigation>& from, Recordings& recordings, double start_s,
                                 double since_1970_s);

  const std::vector<NavDevice>& devices() const { return devices_; }
  std::string names() const;  ///< of the devices
  std::size_t messages() const;
  std::size_t damaged() const;
  const LivePoses& poses() const { return poses_; }
  std::vector<LivePoses::NewFrame> take_new_frames() { return poses_.take_new_frames(); }

  /// Reads what has arrived at all devices. @return the first error, after which it may be called again
  Result<void> step(double now_s);

  /// On the beams' clock.
  double now_s() const { return now_s_; }
  /// Whether the pose of a beam may still become known.
  bool may_come(double beam_s) const;

 private:
  Navigation(std::vector<NavDevice> devices, double start_s) : devices_(std::move(devices)), start_s_(start_s) {}

  std::vector<NavDevice> devices_;
  LivePoses poses_;
  double start_s_, now_s_ = 0.0;
};

}  // namespace pingvox::app
