#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "device/internal/guarded_recorder.hpp"
#include "device/internal/link.hpp"
#include "io/internal/mavlink_nav.hpp"
#include "io/internal/tlog_recorder.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Navigation that a vehicle sends by MAVLink to this host over UDP, as to a ground station. Anybody may send to the
/// port, and most vehicles are system 1. So the first sender that tells of navigation is followed, by its address and
/// system; what others tell is neither read nor recorded, but for ground stations at the same address (a router's).
/// After five seconds without navigation from it, a sender that was not heard beside it is followed in its place, as an
/// autopilot that restarted at another port. It never blocks and has no clock of its own: the caller polls it,
/// at least once a second. Bytes are recorded before they are parsed.
class MavlinkReceiver {
 public:
  struct Status {
    std::size_t frames = 0;                ///< whose checksum is right, of the vehicle that is followed
    std::size_t damaged = 0;               ///< datagrams with other bytes
    std::string vehicle;                   ///< who is followed, as "192.168.2.2:14550 (system 1)"; empty: nobody yet
    std::size_t vehicles = 0;              ///< that were followed, one after the other
    std::size_t ignored = 0;               ///< frames of others
    std::vector<std::string> others;       ///< who they are: the first ones that tell of navigation
    std::optional<Error> recording_error;  ///< what is wrong with the recording; the navigation goes on
  };

  /// @param address        "udp://:PORT" at all addresses of this host, or "udp://ADDRESS:PORT" at one of them
  /// @param since_1970_s   time of the recording at 0 of the clock of now_s
  /// @return kBadOption for another address, kIo when it cannot be opened
  static Result<MavlinkReceiver> listen(const std::string& address, std::optional<TlogRecorder> recorder,
                                        double since_1970_s);

  /// Ends the recording, and begins another one. nullopt: none.
  void record_to(std::optional<TlogRecorder> recorder) { recorder_.record_to(std::move(recorder)); }

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
  /// One of those that send.
  struct Sender {
    std::vector<std::uint8_t> address;
    std::uint8_t system = 0;
    double first_s = 0.0, last_s = 0.0;  ///< when it told of navigation
  };

  void take(std::span<const std::uint8_t> datagram, double now_s, std::vector<MavlinkNav::Report>& reports);
  bool is_followed(const MavlinkFrame& frame, double now_s);
  Sender* other(const MavlinkFrame& frame, double now_s);
  std::string sender_text(std::uint8_t system) const;

  Link link_;
  GuardedRecorder<TlogRecorder> recorder_;
  double since_1970_s_;
  MavlinkNav nav_;
  std::optional<Sender> vehicle_;
  std::vector<Sender> others_;  ///< that told of navigation and are not followed
  Status status_;
};

}  // namespace pingvox
