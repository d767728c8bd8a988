#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "device/internal/head_emulator.hpp"
#include "io/internal/frame_finder.hpp"

namespace pingvox {

struct MicronCommand;

/// A Tritech Micron at the other end of a line: sends mtAlive once a second, takes parameters, finds its
/// centre, and answers each request with a line at the next bearing. After a stall it has lost its parameters. It has
/// no line and no clock of its own: the caller carries the bytes.
class MicronEmulator {
 public:
  /// Returns of the world at a bearing (of 6400 a turn, clockwise, 3200 ahead): the intensities of some bins of a
  /// length.
  using Hear = std::function<std::vector<std::uint8_t>(int bearing, std::size_t bins, double bin_length_m)>;

  /// REQUIRES valid options.
  MicronEmulator(const HeadEmulatorOptions& options, Hear hear);
  ~MicronEmulator();

  /// Takes bytes from the line.
  void take(std::span<const std::uint8_t> bytes, double now_s);
  /// The bytes to send now: one frame, with the faults of the line; empty: none.
  std::vector<std::uint8_t> send(double now_s);
  /// When the next frame is to be sent.
  double due_s() const;

  /// Lines that were sent.
  std::size_t pings() const { return pings_; }

 private:
  struct Answer {
    double due_s;
    std::vector<std::uint8_t> frame;
    bool is_ping;
  };
  void answer(std::span<const std::uint8_t> frame, double now_s);
  std::vector<std::uint8_t> alive(double now_s) const;
  std::vector<std::uint8_t> line();
  void turn();

  HeadEmulatorOptions options_;
  Hear hear_;
  FrameFinder finder_;
  std::deque<Answer> answers_;
  std::unique_ptr<MicronCommand> command_;  ///< nullptr: none yet
  int bearing_ = 3200, sense_ = 1;
  double ready_s_ = 0.0;  ///< when it has found its centre
  double alive_s_ = 0.0;  ///< when it says next that it is there
  double silent_until_s_ = -std::numeric_limits<double>::infinity();
  std::size_t pings_ = 0;
  LineFaults faults_;
};

}  // namespace pingvox
