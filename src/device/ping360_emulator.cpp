#include "device/internal/ping360_emulator.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <string>
#include <string_view>
#include <utility>

#include "device/ping_fields.hpp"
#include "io/internal/ping_frame.hpp"
#include "pingvox/sonar/device_profile.hpp"

namespace pingvox {
namespace {

constexpr std::size_t kMaxSamples = 1200, kTransducerSize = 14, kAutoTransmitSize = 16;

std::vector<std::uint8_t> frame_from_head(PingMessage message, std::span<const std::uint8_t> payload) {
  return make_ping_frame(message, kPingHead, kPingHost, payload);
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
    : options_(options),
      hear_(std::move(hear)),
      finder_(check_ping_frame),
      scan_faults_(options.seed),
      faults_(options) {
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
  const auto say = [&](std::vector<std::uint8_t> answer) {
    answers_.push_back({now_s, std::move(answer), Answer::Kind::kReply});
  };
  switch (message) {
    case PingMessage::kGeneralRequest: {
      constexpr std::array<std::uint8_t, 6> kInformation = {2, 0x43, 3, 1, 1, 0};  // a Ping360, firmware 3.1.1
      const bool is_information =
          payload.size() == 2 && get_u16(payload, 0) == static_cast<std::uint16_t>(PingMessage::kDeviceInformation);
      return say(is_information ? frame_from_head(PingMessage::kDeviceInformation, kInformation)
                                : reply_to(message, PingMessage::kNack, "unknown message"));
    }
    case PingMessage::kTransducer:
      if (payload.size() != kTransducerSize || get_u16(payload, 2) >= kTurn_grad ||
          get_u16(payload, 10) > kMaxSamples || get_u16(payload, 6) == 0) {
        return say(reply_to(message, PingMessage::kNack, "value out of range"));
      }
      return answers_.push_back({now_s + 1.0 / options_.pings_per_s, ping(payload), Answer::Kind::kPing});
    case PingMessage::kAutoTransmit:
      if (payload.size() != kAutoTransmitSize || get_u16(payload, 4) == 0 || get_u16(payload, 8) > kMaxSamples ||
          get_u16(payload, 10) >= kTurn_grad || get_u16(payload, 12) >= kTurn_grad || payload[14] < 1 ||
          payload[14] > 10 || payload[15] > 100) {
        return say(reply_to(message, PingMessage::kNack, "value out of range"));
      }
      return start_scan(payload, now_s);
    case PingMessage::kMotorOff:
      stop_scan();
      return say(reply_to(message, PingMessage::kAck));
    default:
      return say(reply_to(message, PingMessage::kNack, "unknown message"));
  }
}

std::vector<std::uint8_t> Ping360Emulator::hear(int angle_grad, std::uint16_t samples,
                                                std::uint16_t period_25ns) const {
  constexpr double kTick_s = 25e-9;
  std::vector<std::uint8_t> heard = hear_(angle_grad, samples, kAssumedSoundSpeed_m_s * (period_25ns * kTick_s) / 2.0);
  assert(heard.size() == samples);
  return heard;
}

std::vector<std::uint8_t> Ping360Emulator::ping(std::span<const std::uint8_t> transducer) const {
  const bool transmits = transducer[12] != 0;
  std::vector<std::uint8_t> payload(transducer.begin(), transducer.begin() + 12);
  std::vector<std::uint8_t> heard;
  if (transmits) heard = hear(get_u16(transducer, 2), get_u16(transducer, 10), get_u16(transducer, 6));
  put_u16(payload, static_cast<std::uint16_t>(heard.size()));
  payload.insert(payload.end(), heard.begin(), heard.end());
  return frame_from_head(PingMessage::kDeviceData, payload);
}

std::vector<std::uint8_t> Ping360Emulator::ping_of_scan() const {
  const std::vector<std::uint8_t>& settings = scan_->settings;
  const int angle_grad = (scan_->start_grad + scan_->place_grad + kTurn_grad) % kTurn_grad;
  const std::vector<std::uint8_t> heard = hear(angle_grad, get_u16(settings, 8), get_u16(settings, 4));
  std::vector<std::uint8_t> payload;
  const auto put_settings = [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) payload.push_back(settings[i]);
  };
  put_settings(0, 2);
  put_u16(payload, static_cast<std::uint16_t>(angle_grad));
  put_settings(2, 8);
  put_settings(10, settings.size());
  put_u16(payload, get_u16(settings, 8));
  put_u16(payload, static_cast<std::uint16_t>(heard.size()));
  payload.insert(payload.end(), heard.begin(), heard.end());
  return frame_from_head(PingMessage::kAutoDeviceData, payload);
}

void Ping360Emulator::start_scan(std::span<const std::uint8_t> settings, double now_s) {
  stop_scan();
  const int start_grad = get_u16(settings, 10), stop_grad = get_u16(settings, 12);
  scan_ = Scan{.settings = {settings.begin(), settings.end()},
               .start_grad = start_grad,
               .width_grad = (stop_grad - start_grad + kTurn_grad) % kTurn_grad,
               .step_grad = settings[14],
               .interval_s = 1.0 / options_.pings_per_s + 1e-3 * settings[15]};
  answers_.push_back({now_s + scan_->interval_s, ping_of_scan(), Answer::Kind::kPingOfScan});
}

void Ping360Emulator::stop_scan() {
  scan_.reset();
  std::erase_if(answers_, [](const Answer& answer) { return answer.kind == Answer::Kind::kPingOfScan; });
}

void Ping360Emulator::turn(Scan& scan) {
  constexpr double kSkipped = 0.02, kBeyondEnd = 0.5;
  const int step = (scan_faults_.uniform() < kSkipped ? 2 : 1) * scan.step_grad;
  const int next = scan.place_grad + scan.sense * step;
  if (next >= -scan.beyond_grad && next <= scan.width_grad + scan.beyond_grad) {
    scan.place_grad = next;
    return;
  }
  scan.beyond_grad = scan_faults_.uniform() < kBeyondEnd ? scan.step_grad : 0;
  if (scan.width_grad > kTurn_grad / 2) {
    scan.place_grad = 0;
    return;
  }
  scan.sense = -scan.sense;
  // A sector narrower than a step is one angle.
  scan.place_grad = std::clamp(scan.place_grad + scan.sense * scan.step_grad, 0, scan.width_grad);
}

std::vector<std::uint8_t> Ping360Emulator::send(double now_s) {
  if (answers_.empty() || now_s < answers_.front().due_s) return {};
  const Answer answer = std::move(answers_.front());
  answers_.pop_front();
  const bool is_ping = answer.kind != Answer::Kind::kReply;
  if (is_ping) ++pings_;
  if (answer.kind == Answer::Kind::kPingOfScan) {
    turn(*scan_);
    answers_.push_back({now_s + scan_->interval_s, ping_of_scan(), Answer::Kind::kPingOfScan});
  }
  if (is_ping && options_.stall_every > 0 && pings_ % options_.stall_every == 0) {
    silent_until_s_ = now_s + options_.stall_s;
    answers_.clear();
    scan_.reset();
  }
  return faults_.pass(answer.frame);
}

}  // namespace pingvox
