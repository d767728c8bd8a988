#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "device/web_socket.hpp"

// Heads that another program drives: their pings are received, and nothing is sent that would affect them.
namespace pingvox {

/// Tells whether pings come.
class PingWatch {
 public:
  /// Heads that turn far take seconds.
  static constexpr double kSilence_s = 10.0;

  void begin() { *this = PingWatch(); }
  void hear() { is_heard_ = has_heard_ = true; }
  /// To be called after what was heard.
  void update(double now_s) {
    if (has_heard_ || !deadline_s_) deadline_s_ = now_s + kSilence_s;
    has_heard_ = false;
    is_silent_ = now_s >= *deadline_s_;
    if (is_silent_) is_heard_ = false;
  }
  /// Restarts the wait.
  void wait(double now_s) { deadline_s_ = now_s + kSilence_s; }
  double due_s() const { return deadline_s_ && !has_heard_ ? *deadline_s_ : -std::numeric_limits<double>::infinity(); }
  /// Whether pings come.
  bool is_heard() const { return is_heard_; }
  bool is_silent() const { return is_silent_; }

 private:
  std::optional<double> deadline_s_;
  bool is_heard_ = false, has_heard_ = false, is_silent_ = false;
};

/// Listens to a Ping360 at the bridge of BlueOS, which sends all bytes of the head's serial line to each client that it
/// heard of. The first datagram, and one after each ten seconds without a ping, asks the head for the version of its
/// protocol, which changes nothing.
class Ping360Listener {
 public:
  struct Settings {};
  explicit Ping360Listener(const Settings&) {}

  void connect() { *this = Ping360Listener({}); }
  std::optional<std::string> contradiction(std::span<const std::uint8_t>) const { return std::nullopt; }
  void take(std::span<const std::uint8_t> frame);
  void expect_rest(double) {}
  std::optional<std::vector<std::uint8_t>> message(double now_s);
  double due_s() const { return watch_.due_s(); }
  bool is_connected() const { return watch_.is_heard(); }
  /// Reopening the line would take the place of another client of the bridge.
  bool is_lost() const { return false; }
  /// Empty: it is not known yet whether pings come.
  std::string problem() const;
  std::size_t unanswered() const { return unanswered_; }

 private:
  PingWatch watch_;
  bool is_silent_ = false;
  bool has_asked_ = false;
  std::size_t unanswered_ = 0;
};

/// Takes the pings of a Ping360 from the server of Ping Viewer 2.
class PingViewer2Client {
 public:
  struct Settings {
    std::string host;    ///< with its port, as in "192.168.2.2:6060"
    std::string device;  ///< by the server's number of it; empty: the first one that pings
  };
  explicit PingViewer2Client(Settings settings);

  void connect();
  /// The frames of the Ping protocol in bytes of the line, valid until the next call.
  std::span<const std::uint8_t> frames_in(std::span<const std::uint8_t> bytes);
  std::optional<std::string> contradiction(std::span<const std::uint8_t>) const { return std::nullopt; }
  void take(std::span<const std::uint8_t> frame);
  void expect_rest(double) {}
  std::optional<std::vector<std::uint8_t>> message(double now_s);
  double due_s() const;
  bool is_connected() const { return watch_.is_heard(); }
  bool is_lost() const { return !problem_.empty(); }
  std::string problem() const { return problem_; }
  std::size_t unanswered() const { return 0; }

  /// Pings that are left out, and why the first one is.
  std::size_t left_out() const { return left_out_; }
  const std::string& first_left_out() const { return first_left_out_; }

 private:
  void leave_out(const std::string& reason);

  Settings settings_;
  std::string followed_;  ///< the device
  WebSocket socket_;
  PingWatch watch_;
  bool has_asked_ = false;
  std::string problem_;
  std::vector<std::uint8_t> frames_;
  std::size_t left_out_ = 0;
  std::string first_left_out_;
};

}  // namespace pingvox
