#include "pingvox/device/ping360_emulator.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <string>
#include <string_view>
#include <utility>

#include "device/ping_fields.hpp"
#include "pingvox/io/ping_frame.hpp"
#include "pingvox/sonar/device_profile.hpp"

namespace pingvox {
namespace {

constexpr std::uint8_t kHost = 0, kHead = 2;
constexpr std::size_t kMaxSamples = 1200, kTransducerSize = 14;

std::vector<std::uint8_t> frame_from_head(PingMessage message, std::span<const std::uint8_t> payload) {
  return make_ping_frame(message, kHead, kHost, payload);
}

/// An answer that names the message that it is to.
std::vector<std::uint8_t> reply_to(PingMessage asked, PingMessage reply, std::string_view text = {}) {
  std::vector<std::uint8_t> payload;
  put_u16(payload, static_cast<std::uint16_t>(asked));
  payload.insert(payload.end(), text.begin(), text.end());
  return frame_from_head(reply, payload);
}

}  // namespace

Ping360Emulator::Ping360Emulator(const HeadEmulatorOptions& options, Hear hear)
    : options_(options), hear_(std::move(hear)), finder_(check_ping_frame), faults_(options) {
  assert(options.validate());
}

void Ping360Emulator::take(std::span<const std::uint8_t> bytes, double now_s) {
  finder_.push(bytes);
  while (const std::optional<FrameFinder::Frame> frame = finder_.next()) {
    if (now_s >= silent_until_s_) answer(frame->bytes, now_s);
  }
}

void Ping360Emulator::answer(std::span<const std::uint8_t> frame, double now_s) {
  constexpr std::size_t kMaxAnswers = 16;  // hosts ask for one at a time
  if (answers_.size() >= kMaxAnswers) return;
  const PingMessage message = ping_message(frame);
  const std::span<const std::uint8_t> payload = ping_payload(frame);
  const auto say = [&](std::vector<std::uint8_t> answer) { answers_.push_back({now_s, std::move(answer), false}); };
  switch (message) {
    case PingMessage::kGeneralRequest: {
      constexpr std::array<std::uint8_t, 6> kInformation = {2, 0x43, 3, 1, 1, 0};  // a Ping360, firmware 3.1.1
      const bool is_information =
          payload.size() == 2 && get_u16(payload, 0) == static_cast<std::uint16_t>(PingMessage::kDeviceInformation);
      return say(is_information ? frame_from_head(PingMessage::kDeviceInformation, kInformation)
                                : reply_to(message, PingMessage::kNack, "unknown message"));
    }
    case PingMessage::kTransducer:
      if (payload.size() != kTransducerSize || get_u16(payload, 2) >= 400 || get_u16(payload, 10) > kMaxSamples ||
          get_u16(payload, 6) == 0) {
        return say(reply_to(message, PingMessage::kNack, "value out of range"));
      }
      return answers_.push_back({now_s + 1.0 / options_.pings_per_s, ping(payload), true});
    case PingMessage::kMotorOff:
      return say(reply_to(message, PingMessage::kAck));
    default:
      return say(reply_to(message, PingMessage::kNack, "unknown message"));
  }
}

std::vector<std::uint8_t> Ping360Emulator::ping(std::span<const std::uint8_t> transducer) {
  constexpr double kTick_s = 25e-9;
  const std::size_t samples = get_u16(transducer, 10);
  const bool transmits = transducer[12] != 0;
  std::vector<std::uint8_t> payload(transducer.begin(), transducer.begin() + 12);
  std::vector<std::uint8_t> heard;
  if (transmits) {
    heard = hear_(get_u16(transducer, 2), samples, kAssumedSoundSpeed_m_s * (get_u16(transducer, 6) * kTick_s) / 2.0);
  }
  assert(heard.size() == (transmits ? samples : 0));
  put_u16(payload, static_cast<std::uint16_t>(heard.size()));
  payload.insert(payload.end(), heard.begin(), heard.end());
  return frame_from_head(PingMessage::kDeviceData, payload);
}

std::vector<std::uint8_t> Ping360Emulator::send(double now_s) {
  if (answers_.empty() || now_s < answers_.front().due_s) return {};
  const Answer answer = std::move(answers_.front());
  answers_.pop_front();
  if (answer.is_ping) ++pings_;
  if (answer.is_ping && options_.stall_every > 0 && pings_ % options_.stall_every == 0) {
    silent_until_s_ = now_s + options_.stall_s;
    answers_.clear();
  }
  return faults_.pass(answer.frame);
}

}  // namespace pingvox
