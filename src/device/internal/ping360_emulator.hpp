#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "device/internal/head_emulator.hpp"
#include "io/internal/frame_finder.hpp"
#include "pingvox/geometry/random.hpp"

namespace pingvox {

/// A Ping360 at the other end of a line: answers requests for its information, pings, a scan (auto_transmit) and
/// motor_off. It has no line and no clock of its own: the caller carries the bytes.
///
/// A scan is as users of the head describe it (discuss.bluerobotics.com/t/21935): to and fro over up to half a turn,
/// else in one sense; some angles are left out, and at its ends the head sometimes goes a step too far. It ends by
/// motor_off.
class Ping360Emulator {
 public:
  /// Returns of the world at an angle (of 400 a turn, clockwise, 200 ahead): the intensities of some bins of a length.
  using Hear = std::function<std::vector<std::uint8_t>(int angle_grad, std::size_t bins, double bin_length_m)>;

  /// REQUIRES valid options.
  Ping360Emulator(const HeadEmulatorOptions& options, Hear hear);

  /// Takes bytes from the line.
  void take(std::span<const std::uint8_t> bytes, double now_s);
  /// The bytes to send now: one frame, with the faults of the line; empty: none.
  std::vector<std::uint8_t> send(double now_s);
  /// When the next frame is to be sent; infinity: when the host asks for one.
  double due_s() const { return answers_.empty() ? std::numeric_limits<double>::infinity() : answers_.front().due_s; }

  /// Pings that were sent.
  std::size_t pings() const { return pings_; }

 private:
  struct Answer {
    enum class Kind { kReply, kPing, kPingOfScan };
    double due_s;
    std::vector<std::uint8_t> frame;
    Kind kind;
  };
  struct Scan {
    std::vector<std::uint8_t> settings;  ///< payload of auto_transmit
    int start_grad, width_grad, step_grad;
    double interval_s;
    int place_grad = 0, sense = 1;  ///< from the start, clockwise
    int beyond_grad = 0;            ///< how far this pass goes over the end
  };
  void answer(std::span<const std::uint8_t> frame, double now_s);
  std::vector<std::uint8_t> hear(int angle_grad, std::uint16_t samples, std::uint16_t period_25ns) const;
  std::vector<std::uint8_t> ping(std::span<const std::uint8_t> transducer) const;
  std::vector<std::uint8_t> ping_of_scan() const;
  void start_scan(std::span<const std::uint8_t> settings, double now_s);
  void stop_scan();
  void turn(Scan& scan);

  HeadEmulatorOptions options_;
  Hear hear_;
  FrameFinder finder_;
  std::deque<Answer> answers_;
  std::optional<Scan> scan_;
  Random scan_faults_;
  std::size_t pings_ = 0;
  double silent_until_s_ = -std::numeric_limits<double>::infinity();
  LineFaults faults_;
};

}  // namespace pingvox
