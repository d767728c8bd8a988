#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "pingvox/device/head_emulator.hpp"
#include "pingvox/io/frame_finder.hpp"

namespace pingvox {

/// A Ping360 at the other end of a line: answers requests for its information, pings and motor_off. It has no line and
/// no clock of its own: the caller carries the bytes.
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
    double due_s;
    std::vector<std::uint8_t> frame;
    bool is_ping;
  };
  void answer(std::span<const std::uint8_t> frame, double now_s);
  std::vector<std::uint8_t> ping(std::span<const std::uint8_t> transducer);

  HeadEmulatorOptions options_;
  Hear hear_;
  FrameFinder finder_;
  std::deque<Answer> answers_;
  std::size_t pings_ = 0;
  double silent_until_s_ = -std::numeric_limits<double>::infinity();
  LineFaults faults_;
};

}  // namespace pingvox
