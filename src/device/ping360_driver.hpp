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

/// Sampling of one ping.
struct Ping360Sampling {
  std::uint16_t samples = 0;
  std::uint16_t period_25ns = 0;  ///< from sample to sample
  std::uint16_t transmit_us = 0;  ///< length of the pulse
};

/// Sampling that Ping Viewer chooses for a range: up to 1200 samples, in steps of at least 2 us. REQUIRES a range of
/// 0.5 m to 100 m.
Ping360Sampling ping360_sampling(double range_m);

/// The host's side of the dialogue with a Ping360: asks who is there, then for one ping after the other, and repeats
/// what is not answered. It has no line and no clock of its own: the caller carries the messages.
class Ping360Driver {
 public:
  /// REQUIRES valid settings.
  explicit Ping360Driver(const Ping360Settings& settings);

  /// Changes the settings from the next request on. REQUIRES valid settings.
  void drive(const Ping360Settings& settings);
  /// Begins the dialogue on a new line; the head goes on turning from where it was.
  void connect();
  /// Why a valid frame of the Ping protocol is a ping that does not match its request, with the two values that differ;
  /// nullopt: it matches, or is no ping. An answer to the request before the last may be late.
  std::optional<std::string> contradiction(std::span<const std::uint8_t> frame) const;
  /// Takes a valid frame of the Ping protocol from the line.
  void take(std::span<const std::uint8_t> frame);
  /// Of an answer that has begun: what is missing comes by then, or was lost.
  void expect_rest(double until_s);
  /// The message to send now; nullopt while an answer may still come.
  std::optional<std::vector<std::uint8_t>> message(double now_s);
  /// When `message` has to be called again, unless a frame comes before.
  double due_s() const {
    return is_waiting_ ? std::min(deadline_s_, rest_until_s_) : -std::numeric_limits<double>::infinity();
  }

  /// Whether a Ping360 answered since `connect`.
  bool is_connected() const { return is_known_; }
  /// Several messages in a row were not answered: the line has to be opened again.
  bool is_lost() const;
  /// Why: "no answer", or with which words the head refused the messages.
  std::string problem() const;
  /// Messages that were not answered in time.
  std::size_t unanswered() const { return unanswered_; }

  /// The last message, which stops the motor.
  static std::vector<std::uint8_t> motor_off();

 private:
  void turn();
  void take_settings();
  std::vector<std::uint8_t> ping() const;

  Ping360Settings settings_;
  std::optional<Ping360Settings> next_settings_;  ///< from the next request on
  Ping360Sampling sampling_;
  int angle_grad_;
  std::optional<int> asked_grad_, asked_before_grad_;  ///< angles of the last request for a ping and of the one before
  int place_grad_ = 0;                                 ///< in the sector
  int sense_ = 1;                                      ///< of turning in the sector: 1 clockwise, -1 counter-clockwise
  bool is_known_ = false, is_waiting_ = false;
  double deadline_s_ = 0.0;
  double rest_until_s_ = 0.0;  ///< for the rest of an answer that has begun
  int unanswered_in_a_row_ = 0;
  std::size_t unanswered_ = 0;
  std::string refusal_;  ///< empty: none since the last answer
};

}  // namespace pingvox
