#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

/// Parameters of a SeaNet head.
namespace pingvox {

/// Of a head, in steps.
inline constexpr int kMicronTurn = 6400;

/// Parameters of a single-channel head (mtHeadCommand of 66 bytes, docs/formats.md), in raw units.
struct MicronCommand {
  /// Bits of `control`: samples of 8 bits, full turns; what else is usual.
  static constexpr std::uint16_t kEightBits = 1, kContinuous = 2, kUsual = 0x2304;
  static constexpr std::uint8_t kImaging = 2, kDst = 0x11;

  std::uint16_t control = kUsual | kEightBits | kContinuous;
  std::uint8_t head_type = kDst;
  double frequency_hz = 0.0;  ///< 0: the head's own, as for DST heads
  std::uint16_t pulse_us = 50;
  std::uint16_t range_dm = 0;  ///< a label
  std::uint16_t left = 0, right = 0;
  std::uint8_t span = 81, low = 8;  ///< of the samples of four bits, 255 for 80 dB
  std::uint8_t gain = 84;           ///< 0..210
  std::uint16_t slope = 0;
  std::uint8_t step = 16;
  std::uint16_t interval_640ns = 0, bins = 0;
};

/// The whole frame.
std::vector<std::uint8_t> frame_of(const MicronCommand& command);

/// The parameters that an emulated head uses. nullopt: another layout of parameters.
std::optional<MicronCommand> micron_command_in(std::span<const std::uint8_t> payload);

}  // namespace pingvox
