#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "device/internal/ros2_node.hpp"
#include "io/internal/ping_viewer_recorder.hpp"
#include "io/internal/seanet_recorder.hpp"
#include "pingvox/device/head_settings.hpp"
#include "pingvox/device/head_status.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// How a head is driven.
using DrivenHead = std::variant<Ping360Settings, MicronSettings>;

/// What the bytes of a head are recorded by.
using HeadRecorder = std::variant<PingViewerRecorder, SeanetRecorder>;

/// A non-blocking source of beams: the caller polls it. It has no clock of its own.
class LiveSource {
 public:
  virtual ~LiveSource() = default;
  /// To wait for with poll(), along with `due_s`; -1: none.
  virtual int descriptor() const { return -1; }
  /// When `step` has to be called again, if the descriptor is not ready before.
  virtual double due_s() const = 0;
  /// Reads, records and sends what is due, without waiting, and appends the beams that came.
  /// @param now_s  seconds of a clock that never goes back
  /// @return false at the end (a device has none); an error when nothing more can be read
  virtual Result<bool> step(double now_s, std::vector<Beam>& beams) = 0;
  /// Stops the head, and appends the beams that waited for more bytes.
  virtual void finish(std::vector<Beam>& beams) = 0;

  /// Drives the head in another way, from its next request on.
  /// @return kUnsupported where these are not the settings of this head
  virtual Result<void> drive(const DrivenHead& settings) = 0;

  /// Ends the recording, and begins another one. nullopt: none.
  /// @return kUnsupported for a recorder of another head
  virtual Result<void> record_to(std::optional<HeadRecorder> recorder) = 0;
  virtual bool is_recording() const = 0;

  virtual HeadStatus status() const = 0;
  /// The sonar head, if known.
  virtual const DeviceProfile* device() const = 0;
};

/// A Ping360 at a line that `Link::open` opens. A line that fails or falls silent is opened again after half a second,
/// then at growing intervals up to ten seconds. Bytes are recorded before they are parsed; reading the recording gives
/// the same beams and those that did not fit their requests, with times from its date on where it has one.
/// REQUIRES valid settings.
std::unique_ptr<LiveSource> ping360_source(const std::string& address, const Ping360Settings& settings,
                                           std::optional<PingViewerRecorder> recorder, double now_s);

/// A Ping360 at the bridge of BlueOS that another program drives: nothing is sent but a harmless request, without which
/// the bridge does not know of us. What the head sends to the other program is received and recorded.
/// @param address  "udp://HOST:PORT"
std::unique_ptr<LiveSource> shared_ping360_source(const std::string& address,
                                                  std::optional<PingViewerRecorder> recorder, double now_s);

/// The pings of a Ping360 that Ping Viewer 2 drives, from its server, as frames of the Ping protocol. Without a ping
/// for ten seconds the connection is reopened.
/// @param address  "tcp://HOST:PORT"
/// @param device   as the server numbers it; empty: the first one that pings
std::unique_ptr<LiveSource> ping_viewer_2_source(const std::string& address, const std::string& device,
                                                 std::optional<PingViewerRecorder> recorder, double now_s);

/// A SeaNet head, a Micron or MiniKing, the same way as a Ping360.
std::unique_ptr<LiveSource> micron_source(const std::string& address, const MicronSettings& settings,
                                          std::optional<SeanetRecorder> recorder, double now_s);

/// Asked several times a second while something is waited for; false ends that.
/// @param problem  why it takes long; empty: it does not yet
using KeepWaiting = std::function<bool(const std::string& problem)>;

/// Waits until somebody publishes a topic. @param keep_waiting  nullptr: for ten seconds
/// @return kIo, with what is seen instead, when nobody does
Result<void> wait_for_ros2_topic(const Ros2Node& node, const std::string& topic, const KeepWaiting& keep_waiting);

/// The beams of a head that a node of ROS 2 drives, by a topic of the messages of its driver. Nothing is recorded.
/// @param since_1970_s  of the clock that `step` is told, at its 0
/// @return kIo when nobody publishes the topic, kUnsupported for messages that are not read as beams
Result<std::unique_ptr<LiveSource>> ros2_source(const Ros2Node& node, const std::string& topic, double since_1970_s);

/// A log, at the pace of its times.
/// @param speed  > 0; 1: as it was; infinity: as fast as the caller asks
std::unique_ptr<LiveSource> replay_source(std::unique_ptr<BeamSource> log, double speed);

}  // namespace pingvox
