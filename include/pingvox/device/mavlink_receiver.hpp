#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pingvox/device/link.hpp"
#include "pingvox/io/mavlink_nav.hpp"
#include "pingvox/io/tlog_recorder.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Navigation that a vehicle sends by MAVLink to this host over UDP, as to a ground station. It never blocks and
/// has no clock of its own: the caller polls it, at least once a second. Bytes are recorded before they are parsed.
class MavlinkReceiver {
 public:
  struct Status {
    std::size_t frames = 0;                ///< whose checksum is right
    std::size_t damaged = 0;               ///< datagrams with other bytes
    std::optional<Error> recording_error;  ///< why the recording ended; the navigation goes on
  };

  /// @param address        "udp://:PORT" or "udp://ADDRESS:PORT", of this host
  /// @param since_1970_s   time of the recording at 0 of the clock of now_s
  /// @return kBadOption for another address, kIo when it cannot be opened
  static Result<MavlinkReceiver> listen(const std::string& address, std::optional<TlogRecorder> recorder,
                                        double since_1970_s);

  /// With the port that was chosen.
  const std::string& address() const { return link_.address(); }
  /// For poll().
  int descriptor() const { return link_.descriptor(); }

  /// Reads what has arrived.
  /// @param now_s  on the clock that the samples' times are wanted on
  /// @return kIo when the socket is lost
  Result<std::vector<MavlinkNav::Report>> read(double now_s);

  const Status& status() const { return status_; }

 private:
  MavlinkReceiver(Link link, std::optional<TlogRecorder> recorder, double since_1970_s)
      : link_(std::move(link)), recorder_(std::move(recorder)), since_1970_s_(since_1970_s) {}
  void take(std::span<const std::uint8_t> datagram, double now_s, std::vector<MavlinkNav::Report>& reports);
  void record(std::span<const std::uint8_t> frame, double now_s);

  Link link_;
  std::optional<TlogRecorder> recorder_;
  double since_1970_s_;
  MavlinkNav nav_;
  Status status_;
};

}  // namespace pingvox
