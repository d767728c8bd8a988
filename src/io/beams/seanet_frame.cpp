#include "io/internal/seanet_frame.hpp"

#include <fmt/core.h>

#include <array>
#include <cassert>
#include <cstring>
#include <utility>

#include "io/beams/device_log.hpp"
#include "io/beams/seanet_bearing.hpp"
#include "io/bytes/byte_reader.hpp"
#include "pingvox/sonar/device_profile.hpp"

namespace pingvox {
namespace {

using Verdict = FrameCheck::Verdict;

/// Of a frame: bytes that its length does not count, offsets of the payload and of the device block of mtHeadData,
/// bytes around the samples.
constexpr std::size_t kUncounted = 6, kPayload = 13, kDeviceBlock = 15, kAroundSamples = 45;
constexpr std::size_t kMinLength = 8, kMaxLength = 4090;
constexpr std::size_t kBlockHeader = 29;  ///< bytes of the device block before its samples

constexpr std::uint8_t kHeadData = 2, kSinglePacket = 0x80;
constexpr std::uint8_t kMessageBehind = 0x80;  ///< of the head's status

/// Why there is no line.
constexpr std::string_view kOtherMessage = "another message", kPartOfLine = "part of a line that is cut into packets",
                           kShort = "shorter than its header", kTooManySamples = "more samples than it has room for";

/// Messages of fixed length.
constexpr std::array kFrameSizes = {std::pair{1, 25},  std::pair{4, 22},  std::pair{16, 14},
                                    std::pair{23, 14}, std::pair{24, 14}, std::pair{25, 18}};

/// Value of an upper-case hexadecimal digit; -1: none.
int hex_digit(std::uint8_t c) {
  if (c >= '0' && c <= '9') return c - '0';
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/// Whether a device block is that of a profiling head, which holds times of echoes in place of samples.
bool is_of_profiling_head(std::span<const std::uint8_t> device_block) {
  return !device_block.empty() && (device_block[0] == 5 || device_block[0] == 20);
}

/// Whether the frame has the length of its message, if that is known.
bool fits_message(std::span<const std::uint8_t> frame) {
  const std::uint8_t id = frame[10];
  for (const auto& [known, size] : kFrameSizes) {
    if (id == known) return frame.size() == static_cast<std::size_t>(size);
  }
  // Parts of a split message have no fixed length.
  if (id != kHeadData || frame[11] != kSinglePacket) return true;
  if (frame.size() < kAroundSamples) return false;
  if (is_of_profiling_head(frame.subspan(kDeviceBlock))) return frame.size() == u16_at(frame, 13) + 14U;
  const std::size_t around = u16_at(frame, 42) + kAroundSamples;
  const bool has_message = (frame[16] & kMessageBehind) != 0;
  return has_message ? frame.size() >= around : frame.size() == around && frame.size() == u16_at(frame, 13) + 14U;
}

}  // namespace

FrameCheck check_seanet_frame(const FrameBytes& from) {
  const std::span<const std::uint8_t> bytes = from.bytes();
  const auto* at = static_cast<const std::uint8_t*>(std::memchr(bytes.data(), '@', bytes.size()));
  const std::size_t before = at != nullptr ? static_cast<std::size_t>(at - bytes.data()) : bytes.size();
  if (before > 0) return {Verdict::kNothing, before};
  std::size_t length = 0;
  for (std::size_t i = 1; i <= 4; ++i) {
    if (i >= bytes.size()) return {Verdict::kIncomplete};
    const int digit = hex_digit(bytes[i]);
    if (digit < 0) return {Verdict::kNothing, 1};
    length = length * 16 + static_cast<std::size_t>(digit);
  }
  if (bytes.size() < 7) return {Verdict::kIncomplete};
  const std::size_t again = u16_at(bytes, 5);
  if (length < kMinLength || length > kMaxLength) return {Verdict::kNothing, 1};
  if (length != again) return {Verdict::kBroken, 7, "two lengths that differ"};
  const std::size_t size = length + kUncounted;
  if (bytes.size() < size) return {Verdict::kIncomplete};
  if (bytes[size - 1] != '\n') return {Verdict::kBroken, size, "no end of the frame where it should be"};
  if (!fits_message(bytes.first(size))) return {Verdict::kBroken, size, "impossible length"};
  return {Verdict::kFrame, size};
}

SeanetMessage seanet_message(std::span<const std::uint8_t> frame) {
  return static_cast<SeanetMessage>(frame[10]);
}

SeanetSender seanet_sender(std::span<const std::uint8_t> frame) {
  return static_cast<SeanetSender>(frame[7]);
}

std::span<const std::uint8_t> seanet_payload(std::span<const std::uint8_t> frame) {
  return frame.subspan(kPayload, frame.size() - kPayload - 1);
}

std::vector<std::uint8_t> make_seanet_frame(SeanetMessage message, SeanetSender sender,
                                            std::span<const std::uint8_t> payload) {
  const std::size_t length = payload.size() + kPayload + 1 - kUncounted;
  assert(length <= kMaxLength);
  const auto low = static_cast<std::uint8_t>(length & 0xffU), high = static_cast<std::uint8_t>(length >> 8);
  const auto head = static_cast<std::uint8_t>(SeanetSender::kHead);
  const bool is_command = sender == SeanetSender::kHost;
  std::vector<std::uint8_t> frame = {'@'};
  for (const char digit : fmt::format("{:04X}", length)) frame.push_back(static_cast<std::uint8_t>(digit));
  // The bytes behind the count, which is 0 in lines of an imaging head.
  const auto counted = static_cast<std::uint8_t>(message == SeanetMessage::kHeadData ? 0 : (length - 5) & 0xffU);
  for (const std::uint8_t byte : {low, high, static_cast<std::uint8_t>(sender),
                                  is_command ? head : static_cast<std::uint8_t>(SeanetSender::kHost), counted,
                                  static_cast<std::uint8_t>(message), kSinglePacket, head}) {
    frame.push_back(byte);
  }
  frame.insert(frame.end(), payload.begin(), payload.end());
  frame.push_back('\n');
  return frame;
}

tl::expected<SeanetLine, std::string_view> seanet_line(std::span<const std::uint8_t> frame) {
  if (frame[10] != kHeadData) return tl::unexpected(kOtherMessage);
  if (frame[11] != kSinglePacket) return tl::unexpected(kPartOfLine);
  return seanet_line_in(frame.subspan(kDeviceBlock, frame.size() - kDeviceBlock - 1));
}

tl::expected<SeanetLine, std::string_view> seanet_line_in(std::span<const std::uint8_t> device_block) {
  if (is_of_profiling_head(device_block)) return tl::unexpected(kProfilingHead);
  if (device_block.size() < kBlockHeader) return tl::unexpected(kShort);
  SeanetLine line;
  line.head_type = device_block[0];
  line.status = device_block[1];
  line.control = u16_at(device_block, 3);
  line.range_scale = u16_at(device_block, 5);
  line.transmit = value_from<std::uint32_t>(device_block.subspan(7, 4), std::endian::little);
  line.gain = device_block[11];
  line.interval_640ns = u16_at(device_block, 18);
  line.bearing = u16_at(device_block, 25);
  const std::size_t samples = u16_at(device_block, 27);
  if (device_block.size() - kBlockHeader < samples) return tl::unexpected(kTooManySamples);
  line.data = device_block.subspan(kBlockHeader, samples);
  return line;
}

tl::expected<Beam, std::string> beam_of(const SeanetLine& line, double time_s) {
  constexpr double kTick_s = 640e-9;
  if (const auto fault = seanet_fault(line.status)) return tl::unexpected(std::string(*fault));
  const std::optional<double> bearing_rad = seanet_bearing_rad(line.bearing);
  if (!bearing_rad) return tl::unexpected(fmt::format("bearing {} of 6400 a turn", line.bearing));

  Beam beam;
  beam.time_s = time_s;
  beam.bearing_rad = *bearing_rad;
  if ((line.control & 1) != 0) {
    beam.intensities.assign(line.data.begin(), line.data.end());
  } else {
    beam.intensities.reserve(2 * line.data.size());
    for (const std::uint8_t pair : line.data) {
      beam.intensities.push_back(static_cast<std::uint8_t>((pair >> 4) * 17));
      beam.intensities.push_back(static_cast<std::uint8_t>((pair & 15) * 17));
    }
  }
  beam.bin_length_m = line.interval_640ns > 0 ? kAssumedSoundSpeed_m_s * (line.interval_640ns * kTick_s) / 2.0
                                              : seanet_bin_length_m(line.range_scale, beam.intensities.size());
  if (const Result<void> valid = validate(beam); !valid) return tl::unexpected(valid.error().message);
  return beam;
}

const DeviceProfile* device_of(const SeanetLine& line) {
  constexpr std::uint8_t kDst = 0x11;
  constexpr double kHz = 32e6 / 4294967296.0;
  // A DST head chirps, so its frequency does not identify it; assume the most common one.
  if (line.head_type == kDst) return find_device("micron");
  return find_device(line.transmit * kHz < 500e3 && line.transmit != 0 ? "seaking-325" : "miniking");
}

tl::expected<std::optional<Beam>, std::string> seanet_beam_in(std::span<const std::uint8_t> frame, double time_s) {
  if (frame[10] != kHeadData) return std::nullopt;
  const auto line = seanet_line(frame);
  if (!line) return tl::unexpected(std::string(line.error()));
  return beam_of(*line, time_s);
}

}  // namespace pingvox
