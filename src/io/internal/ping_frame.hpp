#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "io/internal/frame_finder.hpp"
#include "pingvox/sonar/beam.hpp"

// The Ping protocol of Blue Robotics, as used by scanning sonars (docs/formats.md).
namespace pingvox {

/// A frame has at least its header and checksum.
inline constexpr std::size_t kMinPingFrame = 10;

/// For FrameFinder: checks a frame, its checksum and the length of its message. No frame of a Ping360 has a payload of
/// more than 4096 bytes; longer ones are damage.
FrameCheck check_ping_frame(const FrameBytes& at);
/// The same for logs of SonarView, where payloads of other messages have up to 65,535 bytes.
FrameCheck check_sonarview_frame(const FrameBytes& at);

/// Messages that a Ping360 and its host send each other.
enum class PingMessage : std::uint16_t {
  kAck = 1,
  kNack = 2,
  kDeviceInformation = 4,
  kGeneralRequest = 6,
  kDeviceData = 2300,
  kAutoDeviceData = 2301,
  kTransducer = 2601,
  kAutoTransmit = 2602,
  kMotorOff = 2903,
};

/// The message of a frame. REQUIRES a valid frame.
PingMessage ping_message(std::span<const std::uint8_t> frame);
/// Its bytes, without header and checksum. REQUIRES a valid frame.
std::span<const std::uint8_t> ping_payload(std::span<const std::uint8_t> frame);
/// A frame with this message.
/// @param source, destination  ids of devices: 0 the host, 2 a Ping360
/// REQUIRES a payload of at most 4096 bytes
std::vector<std::uint8_t> make_ping_frame(PingMessage message, std::uint8_t source, std::uint8_t destination,
                                          std::span<const std::uint8_t> payload);

/// One ping of a Ping360 (device_data, auto_device_data), in raw units.
struct Ping360Ping {
  std::uint8_t gain = 0;               ///< 0 low, 1 normal, 2 high
  std::uint16_t angle_grad = 0;        ///< 0..399 clockwise, 200 is ahead
  std::uint16_t transmit_us = 0;       ///< length of the pulse
  std::uint16_t period_25ns = 0;       ///< from sample to sample
  std::uint16_t frequency_khz = 0;     ///< of the pulse
  std::uint16_t samples = 0;           ///< requested; none are present if the ping was not sent
  std::span<const std::uint8_t> data;  ///< nearest first; a view of the frame
};

/// nullopt: another message. REQUIRES a valid frame.
std::optional<Ping360Ping> ping360_ping(std::span<const std::uint8_t> frame);

/// Converts to a beam in the sensor frame, assuming kAssumedSoundSpeed_m_s; the error is the reason why it is invalid.
tl::expected<Beam, std::string> beam_of(const Ping360Ping& ping, double time_s);

/// The beam of a frame; nullopt: another message; the error is the reason why it is invalid. REQUIRES a valid frame.
tl::expected<std::optional<Beam>, std::string> ping_beam_in(std::span<const std::uint8_t> frame, double time_s);

}  // namespace pingvox
