#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/internal/ping_viewer_recorder.hpp"
#include "io/internal/seanet_recorder.hpp"
#include "pingvox/device/head_settings.hpp"
#include "pingvox/device/head_status.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

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

/// A SeaNet head, a Micron or MiniKing, the same way.
std::unique_ptr<LiveSource> micron_source(const std::string& address, const MicronSettings& settings,
                                          std::optional<SeanetRecorder> recorder, double now_s);

/// A log, at the pace of its times.
/// @param speed  > 0; 1: as it was; infinity: as fast as the caller asks
std::unique_ptr<LiveSource> replay_source(std::unique_ptr<BeamSource> log, double speed);

}  // namespace pingvox
