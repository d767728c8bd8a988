#include "io/internal/ping_frame.hpp"

#include <fmt/core.h>

#include <cassert>
#include <cstring>
#include <limits>
#include <numbers>

#include "io/bytes/byte_reader.hpp"
#include "pingvox/sonar/device_profile.hpp"

namespace pingvox {
namespace {

using Verdict = FrameCheck::Verdict;

constexpr std::size_t kPingHeaderBytes = 8, kChecksumBytes = 2;
/// More than any message of a Ping360 needs; limits how many frames a damaged length delays.
constexpr std::size_t kMaxPing360Payload = 4096;

/// Size of a payload before its samples, including their count; 0: another message.
std::size_t fixed_part(std::uint16_t id) {
  if (id == static_cast<std::uint16_t>(PingMessage::kDeviceData)) return 14;
  return id == static_cast<std::uint16_t>(PingMessage::kAutoDeviceData) ? 20 : 0;
}

FrameCheck check_frame(const FrameBytes& at, std::size_t max_payload) {
  const std::span<const std::uint8_t> bytes = at.bytes();
  const auto* b = static_cast<const std::uint8_t*>(std::memchr(bytes.data(), 'B', bytes.size()));
  const std::size_t before = b != nullptr ? static_cast<std::size_t>(b - bytes.data()) : bytes.size();
  if (before > 0) return {Verdict::kNothing, before};
  if (bytes.size() < 2) return {Verdict::kIncomplete};
  if (bytes[1] != 'R') return {Verdict::kNothing, 1};
  if (bytes.size() < 4) return {Verdict::kIncomplete};

  const std::size_t payload = u16_at(bytes, 2);
  if (payload > max_payload) return {Verdict::kBroken, 4, "impossible length"};
  const std::size_t size = kPingHeaderBytes + payload + kChecksumBytes;
  if (bytes.size() < kPingHeaderBytes) return {Verdict::kIncomplete};
  if (const std::size_t fixed = fixed_part(u16_at(bytes, 4)); fixed > 0) {
    // Before the frame is whole: a live head would be silent until a damaged length is filled.
    if (payload < fixed) return {Verdict::kBroken, kPingHeaderBytes, "impossible length"};
    if (bytes.size() < kPingHeaderBytes + fixed) return {Verdict::kIncomplete};
    const bool fits = payload - fixed == u16_at(bytes, kPingHeaderBytes + fixed - 2);
    if (!fits) return {Verdict::kBroken, kPingHeaderBytes + fixed, "impossible length"};
  }
  if (bytes.size() < size) return {Verdict::kIncomplete};
  if (at.sum(size - kChecksumBytes) != u16_at(bytes, size - kChecksumBytes))
    return {Verdict::kBroken, size, "wrong checksum"};
  return {Verdict::kFrame, size};
}

}  // namespace

FrameCheck check_ping_frame(const FrameBytes& at) {
  return check_frame(at, kMaxPing360Payload);
}

FrameCheck check_sonarview_frame(const FrameBytes& at) {
  return check_frame(at, std::numeric_limits<std::uint16_t>::max());
}

PingMessage ping_message(std::span<const std::uint8_t> frame) {
  return static_cast<PingMessage>(u16_at(frame, 4));
}

std::span<const std::uint8_t> ping_payload(std::span<const std::uint8_t> frame) {
  return frame.subspan(kPingHeaderBytes, frame.size() - kPingHeaderBytes - kChecksumBytes);
}

std::vector<std::uint8_t> make_ping_frame(PingMessage message, std::uint8_t source, std::uint8_t destination,
                                          std::span<const std::uint8_t> payload) {
  assert(payload.size() <= kMaxPing360Payload);
  std::vector<std::uint8_t> frame = {'B', 'R'};
  const auto put = [&frame](std::size_t value) {
    frame.push_back(static_cast<std::uint8_t>(value & 0xffU));
    frame.push_back(static_cast<std::uint8_t>(value >> 8U));
  };
  put(payload.size());
  put(static_cast<std::size_t>(message));
  frame.push_back(source);
  frame.push_back(destination);
  frame.insert(frame.end(), payload.begin(), payload.end());
  put(FrameBytes{frame}.sum(frame.size()));
  return frame;
}

std::optional<Ping360Ping> ping360_ping(std::span<const std::uint8_t> frame) {
  const std::size_t fixed = fixed_part(u16_at(frame, 4));
  if (fixed == 0) return std::nullopt;
  Ping360Ping ping;
  ping.gain = frame[9];
  ping.angle_grad = u16_at(frame, 10);
  ping.transmit_us = u16_at(frame, 12);
  ping.period_25ns = u16_at(frame, 14);
  ping.frequency_khz = u16_at(frame, 16);
  ping.samples = u16_at(frame, kPingHeaderBytes + fixed - 4);
  ping.data = frame.subspan(kPingHeaderBytes + fixed, frame.size() - kPingHeaderBytes - fixed - kChecksumBytes);
  return ping;
}

tl::expected<Beam, std::string> beam_of(const Ping360Ping& ping, double time_s) {
  constexpr double kTurn_grad = 400.0, kAhead_grad = 200.0, kTick_s = 25e-9;
  if (ping.samples != 0 && !ping.data.empty() && ping.data.size() != ping.samples) {
    return tl::unexpected(fmt::format("number_of_samples {} does not fit {} samples", ping.samples, ping.data.size()));
  }
  if (ping.angle_grad > kTurn_grad) return tl::unexpected(fmt::format("angle {} of 400 a turn", ping.angle_grad));
  Beam beam;
  beam.time_s = time_s;
  beam.bearing_rad = wrap_bearing((kAhead_grad - ping.angle_grad) * (2.0 * std::numbers::pi / kTurn_grad));
  beam.bin_length_m = kAssumedSoundSpeed_m_s * (ping.period_25ns * kTick_s) / 2.0;
  beam.intensities.assign(ping.data.begin(), ping.data.end());
  if (const Result<void> valid = validate(beam); !valid) return tl::unexpected(valid.error().message);
  return beam;
}

tl::expected<std::optional<Beam>, std::string> ping_beam_in(std::span<const std::uint8_t> frame, double time_s) {
  const std::optional<Ping360Ping> ping = ping360_ping(frame);
  if (!ping) return std::nullopt;
  return beam_of(*ping, time_s);
}

}  // namespace pingvox
