#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "device/internal/guarded_recorder.hpp"
#include "device/internal/link.hpp"
#include "io/internal/a50_nav.hpp"
#include "io/internal/record_file.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Navigation of a Water Linked DVL, whose TCP port this host connects to. A connection that fails or falls silent is
/// opened again after half a second, then at growing intervals up to ten seconds. It never blocks and has no clock of
/// its own: the caller polls it, at least once a second. Bytes are recorded before they are parsed.
class A50Receiver {
 public:
  struct Status {
    bool is_connected = false;             ///< a report came on this connection
    std::size_t connections = 0;           ///< how often it was connected
    std::string problem;                   ///< why it is not connected, or not any more
    std::size_t reports = 0;               ///< whole lines of JSON, of all kinds
    std::size_t damaged = 0;               ///< other lines
    std::optional<Error> recording_error;  ///< what is wrong with the recording; the navigation goes on
  };

  /// @param address       "tcp://HOST:PORT"
  /// @param recorder      its lines are those of the device with the time when each came in front; nullopt: none
  /// @param since_1970_s  time of the recording at 0 of the clock of now_s
  /// @return kBadOption for another address
  static Result<A50Receiver> make(const std::string& address, std::optional<RecordFile> recorder, double since_1970_s);

  /// Ends the recording, and begins another one. nullopt: none.
  void record_to(std::optional<RecordFile> recorder) { recorder_.record_to(std::move(recorder)); }

  const std::string& address() const { return address_; }
  /// For poll(); -1: not connected.
  int descriptor() const { return link_ ? link_->descriptor() : -1; }

  /// Connects where it is due, and reads what has arrived.
  /// @param now_s  on the clock that the samples' times are wanted on
  /// @return one sample each
  std::vector<NavSource> read(double now_s);

  const Status& status() const { return status_; }

 private:
  A50Receiver(std::string address, std::optional<RecordFile> recorder, double since_1970_s);
  void open(double now_s);
  void close(std::string problem, double now_s);
  void take(std::span<const std::uint8_t> bytes, double now_s, std::vector<NavSource>& samples);
  void take_line(const std::string& line, double now_s, std::vector<NavSource>& samples);

  static constexpr double kFirstDelay_s = 0.5;
  std::string address_;
  GuardedRecorder<RecordFile> recorder_;
  double since_1970_s_;
  std::optional<LinkOpening> opening_;
  std::optional<Link> link_;
  std::string line_;  ///< the part that has arrived
  A50Nav nav_;
  Status status_;
  std::optional<double> open_at_s_;  ///< nullopt: now
  double heard_s_ = 0.0, delay_s_ = kFirstDelay_s;
};

}  // namespace pingvox
