#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "io/internal/frame_finder.hpp"
#include "pingvox/sonar/beam.hpp"

// The SeaNet protocol of Tritech's scanning heads, as used by imaging sonars (docs/formats.md).
namespace pingvox {

/// For FrameFinder: checks a frame, its two lengths, its end and the length of its message. The protocol has no
/// checksum, so changed samples are not detected.
FrameCheck check_seanet_frame(const FrameBytes& from);

/// Kind of a message between host and head.
enum class SeanetMessage : std::uint8_t {
  kVersionData = 1,
  kHeadData = 2,
  kAlive = 4,
  kUserData = 6,
  kReboot = 16,
  kHeadCommand = 19,
  kSendVersion = 23,
  kSendUserData = 24,
  kSendData = 25,
};
/// Who sends a message.
enum class SeanetSender : std::uint8_t { kHead = 2, kHost = 0xff };

/// The message of a frame, which may be one that has no name here. REQUIRES a valid frame.
SeanetMessage seanet_message(std::span<const std::uint8_t> frame);
SeanetSender seanet_sender(std::span<const std::uint8_t> frame);
/// What is behind the head of a frame. REQUIRES a valid frame.
std::span<const std::uint8_t> seanet_payload(std::span<const std::uint8_t> frame);
/// A frame between a host and an imaging head. REQUIRES at most 4000 bytes.
std::vector<std::uint8_t> make_seanet_frame(SeanetMessage message, SeanetSender sender,
                                            std::span<const std::uint8_t> payload);

/// One line of an imaging head (mtHeadData), in raw units.
struct SeanetLine {
  std::uint8_t head_type = 0;          ///< 2 or 0x11 (DST)
  std::uint8_t status = 0;             ///< bits: 0 no power, 1 motor lost its step, 4 8-bit samples, 7 message behind
  std::uint16_t control = 0;           ///< HdCtrl; bit 0: 8-bit samples
  std::uint16_t range_scale = 0;       ///< low 14 bits tenths of a unit; high 2 bits: 0 m, 1 ft, 2 fathom, 3 yard
  std::uint32_t transmit = 0;          ///< frequency * 2^32 / 32 MHz
  std::uint8_t gain = 0;               ///< 0..210
  std::uint16_t interval_640ns = 0;    ///< from sample to sample; 0: by the range scale
  std::uint16_t bearing = 0;           ///< 1/16 gradian clockwise, 3200 is ahead
  std::span<const std::uint8_t> data;  ///< one sample per byte, or two, the nearer in the high bits
};

/// The error is why there is none: another message, part of a line, a profiling head's. REQUIRES a valid frame.
tl::expected<SeanetLine, std::string_view> seanet_line(std::span<const std::uint8_t> frame);

/// Parses the device block of mtHeadData, from its device type on, which V4LOG files hold too. The error is why it is
/// no line: too short, or of a profiling head.
tl::expected<SeanetLine, std::string_view> seanet_line_in(std::span<const std::uint8_t> device_block);

/// Converts to a beam in the sensor frame, assuming kAssumedSoundSpeed_m_s; the error is the reason why it is invalid.
/// Samples of 4 bits are scaled to 0..255.
tl::expected<Beam, std::string> beam_of(const SeanetLine& line, double time_s);

/// The beam of a frame; nullopt: another message; the error is the reason why there is none: values that are
/// impossible, a line that is cut into several packets, a profiling head. REQUIRES a valid frame.
tl::expected<std::optional<Beam>, std::string> seanet_beam_in(std::span<const std::uint8_t> frame, double time_s);

/// The head by type and frequency of a line; nullptr if unknown.
const DeviceProfile* device_of(const SeanetLine& line);

}  // namespace pingvox
