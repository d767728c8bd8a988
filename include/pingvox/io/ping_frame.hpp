#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tl/expected.hpp>

#include "pingvox/io/frame_finder.hpp"
#include "pingvox/sonar/beam.hpp"

// The Ping protocol of Blue Robotics, as far as a scanning sonar needs it (docs/formats.md).
namespace pingvox {

/// For a FrameFinder: one frame of the protocol, its checksum and the length that its message prescribes.
FrameCheck check_ping_frame(std::span<const std::uint8_t> bytes);

/// One ping of a Ping360 (device_data, auto_device_data), in its own units.
struct Ping360Ping {
  std::uint8_t gain = 0;               ///< 0 low, 1 normal, 2 high
  std::uint16_t angle_grad = 0;        ///< 0..399 clockwise, 200 is ahead
  std::uint16_t transmit_us = 0;       ///< length of the pulse
  std::uint16_t period_25ns = 0;       ///< from sample to sample
  std::uint16_t frequency_khz = 0;     ///< of the pulse
  std::uint16_t samples = 0;           ///< asked for; those of a ping that was not sent are not there
  std::span<const std::uint8_t> data;  ///< nearest first; lies in the frame
};

/// nullopt: the frame is another message. REQUIRES a frame that is right.
std::optional<Ping360Ping> ping360_ping(std::span<const std::uint8_t> frame);

/// The ping as a beam of the sensor's frame, heard at kAssumedSoundSpeed_m_s; the error says what is wrong with it.
tl::expected<Beam, std::string> beam_of(const Ping360Ping& ping, double time_s);

}  // namespace pingvox
