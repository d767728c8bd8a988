#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pingvox/device/head_settings.hpp"

namespace pingvox {

/// Sampling of one line.
struct MicronSampling {
  std::uint16_t bins = 0;
  std::uint16_t interval_640ns = 0;  ///< from bin to bin
};

/// Up to 400 bins, of which a line at 115,200 baud brings 25 a second. REQUIRES a range of 0.5 m to 300 m.
MicronSampling micron_sampling(double range_m);

/// The host's side of the dialogue with a SeaNet head, a Micron or MiniKing: waits until the head says that it is
/// there, asks whether it answers a request with one line or two, sends its parameters, and then asks for one line
/// after the other. A head that restarts gets its parameters again. It has no line and no clock of its own: the caller
/// carries the messages.
class MicronDriver {
 public:
  /// REQUIRES valid settings.
  explicit MicronDriver(const MicronSettings& settings);

  /// Changes the settings: the head gets them after the lines that are requested already. REQUIRES valid settings.
  void drive(const MicronSettings& settings);
  /// Begins the dialogue on a new connection.
  void connect();
  /// Why a valid frame of the SeaNet protocol is a line that does not match its request, with the two values that
  /// differ; nullopt: it matches, or is no line. Range and number of bins may be a tenth off: heads round them.
  std::optional<std::string> contradiction(std::span<const std::uint8_t> frame) const;
  /// Takes a valid frame of the SeaNet protocol from the line.
  void take(std::span<const std::uint8_t> frame);
  /// Of an answer that has begun: what is missing comes by then, or was lost.
  void expect_rest(double until_s);
  /// The message to send now; nullopt while an answer may still come.
  std::optional<std::vector<std::uint8_t>> message(double now_s);
  /// When `message` has to be called again, unless a frame comes before.
  double due_s() const {
    return is_waiting_ ? std::min(deadline_s_, rest_until_s_) : -std::numeric_limits<double>::infinity();
  }

  /// Whether the head has its parameters.
  bool is_connected() const { return state_ == State::kScanning; }
  /// Several messages in a row were not answered: the line has to be opened again.
  bool is_lost() const;
  /// Why.
  std::string problem() const { return "no answer"; }
  /// Messages that were not answered in time.
  std::size_t unanswered() const { return unanswered_; }

 private:
  enum class State { kLooking, kAsking, kConfiguring, kScanning };

  void enter(State state);
  std::vector<std::uint8_t> head_command() const;

  MicronSettings settings_;
  std::optional<MicronSettings> next_settings_;  ///< when no line is on its way
  State state_ = State::kLooking;
  bool is_dst_ = true;
  int lines_of_request_ = 1, lines_left_ = 0;
  bool is_waiting_ = false;
  double deadline_s_ = 0.0;
  double rest_until_s_ = 0.0;  ///< for the rest of an answer that has begun
  int unanswered_in_a_row_ = 0;
  std::size_t unanswered_ = 0;
};

}  // namespace pingvox
