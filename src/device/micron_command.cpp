#include "device/micron_command.hpp"

#include <cmath>

#include "device/ping_fields.hpp"
#include "io/internal/seanet_frame.hpp"

namespace pingvox {
namespace {

constexpr std::uint8_t kParametersOnly = 1;
constexpr std::size_t kSize = 52;
constexpr double kMixer_hz = 455e3;

void put_frequency(std::vector<std::uint8_t>& payload, double frequency_hz) {
  constexpr double kUnits_hz = 4294967296.0 / 32e6;
  const auto units = static_cast<std::uint32_t>(frequency_hz * kUnits_hz);
  put_u16(payload, static_cast<std::uint16_t>(units & 0xffffU));
  put_u16(payload, static_cast<std::uint16_t>(units >> 16U));
}

}  // namespace

std::vector<std::uint8_t> frame_of(const MicronCommand& command) {
  constexpr std::uint8_t kMotorStep_10us = 25, kMajorAxis = 1;
  constexpr std::uint16_t kMaxBuffer = 1000, kLockout_us = 100, kMinorAxis = 1600;
  std::vector<std::uint8_t> payload = {kParametersOnly};
  put_u16(payload, command.control);
  payload.push_back(command.head_type);
  const bool is_own = !(command.frequency_hz > 0.0);
  // Each for two channels: transmitter, receiver.
  for (int i = 0; i < 2; ++i) put_frequency(payload, command.frequency_hz);
  for (int i = 0; i < 2; ++i) put_frequency(payload, is_own ? 0.0 : command.frequency_hz + kMixer_hz);
  for (const std::uint16_t word : {command.pulse_us, command.range_dm, command.left, command.right}) {
    put_u16(payload, word);
  }
  for (const std::uint8_t byte : {command.span, command.low, command.gain, command.gain}) payload.push_back(byte);
  for (int i = 0; i < 2; ++i) put_u16(payload, command.slope);
  payload.push_back(kMotorStep_10us);
  payload.push_back(command.step);
  for (const std::uint16_t word : {command.interval_640ns, command.bins, kMaxBuffer, kLockout_us, kMinorAxis}) {
    put_u16(payload, word);
  }
  payload.push_back(kMajorAxis);
  payload.push_back(0);
  put_u16(payload, 0);
  return make_seanet_frame(SeanetMessage::kHeadCommand, SeanetSender::kHost, payload);
}

std::optional<MicronCommand> micron_command_in(std::span<const std::uint8_t> payload) {
  if (payload.size() != kSize || payload[0] != kParametersOnly) return std::nullopt;
  MicronCommand command;
  command.control = get_u16(payload, 1);
  command.head_type = payload[3];
  command.pulse_us = get_u16(payload, 20);
  command.range_dm = get_u16(payload, 22);
  command.left = get_u16(payload, 24);
  command.right = get_u16(payload, 26);
  command.span = payload[28];
  command.low = payload[29];
  command.gain = payload[30];
  command.slope = get_u16(payload, 32);
  command.step = payload[37];
  command.interval_640ns = get_u16(payload, 38);
  command.bins = get_u16(payload, 40);
  return command;
}

}  // namespace pingvox
