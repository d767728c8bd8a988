#include "device/internal/micron_emulator.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "device/micron_command.hpp"
#include "device/ping_fields.hpp"
#include "io/internal/seanet_frame.hpp"
#include "pingvox/sonar/device_profile.hpp"

namespace pingvox {
namespace {

constexpr int kAhead = 3200;
constexpr double kAlive_s = 1.0, kCentre_s = 0.5;
constexpr std::size_t kMaxBins = 1500;

std::vector<std::uint8_t> frame_from_head(SeanetMessage message, std::span<const std::uint8_t> payload) {
  return make_seanet_frame(message, SeanetSender::kHead, payload);
}

void put_u32(std::vector<std::uint8_t>& payload, std::uint32_t value) {
  put_u16(payload, static_cast<std::uint16_t>(value & 0xffffU));
  put_u16(payload, static_cast<std::uint16_t>(value >> 16U));
}

std::vector<std::uint8_t> version() {
  std::vector<std::uint8_t> payload = {0x20, 0x11};
  put_u16(payload, 1000);    // serial number
  put_u32(payload, 40'000);  // length of its program
  put_u16(payload, 0x1234);  // checksum of its program
  payload.push_back(2);      // node
  return frame_from_head(SeanetMessage::kVersionData, payload);
}

/// Of a DST head.
std::vector<std::uint8_t> user_data(int lines_per_request) {
  constexpr std::size_t kUserDataSize = 264 - 14, kDuplex = 146 - 13;
  std::vector<std::uint8_t> payload(kUserDataSize, 0);
  payload[kDuplex] = lines_per_request == 2 ? 0 : 1;
  return frame_from_head(SeanetMessage::kUserData, payload);
}

}  // namespace

MicronEmulator::MicronEmulator(const HeadEmulatorOptions& options, Hear hear)
    : options_(options), hear_(std::move(hear)), finder_(check_seanet_frame), faults_(options) {
  assert(options.validate());
}
MicronEmulator::~MicronEmulator() = default;

void MicronEmulator::take(std::span<const std::uint8_t> bytes, double now_s) {
  finder_.push(bytes);
  while (const std::optional<FrameFinder::Frame> frame = finder_.next()) {
    if (now_s >= silent_until_s_) answer(frame->bytes, now_s);
  }
}

void MicronEmulator::answer(std::span<const std::uint8_t> frame, double now_s) {
  constexpr std::size_t kMaxAnswers = 16;  // hosts ask for one at a time
  if (answers_.size() >= kMaxAnswers) return;
  switch (seanet_message(frame)) {
    case SeanetMessage::kSendVersion:
      return answers_.push_back({now_s, version(), false});
    case SeanetMessage::kSendUserData:
      return answers_.push_back({now_s, user_data(options_.lines_per_request), false});
    case SeanetMessage::kReboot:
      command_.reset();
      return answers_.clear();
    case SeanetMessage::kHeadCommand: {
      const auto command = micron_command_in(seanet_payload(frame));
      if (!command || command->bins == 0 || command->bins > kMaxBins || command->step == 0) return;
      command_ = std::make_unique<MicronCommand>(*command);
      bearing_ = kAhead;
      ready_s_ = alive_s_ = now_s + kCentre_s;
      return;
    }
    case SeanetMessage::kSendData:
      if (!command_ || now_s < ready_s_) return;
      for (int i = 1; i <= options_.lines_per_request; ++i) {
        answers_.push_back({now_s + i / options_.pings_per_s, line(), true});
      }
      return;
    default:
      return;
  }
}

std::vector<std::uint8_t> MicronEmulator::alive(double now_s) const {
  constexpr std::uint8_t kWants = 0x80, kCentred = 1U << 1U, kMotorOn = 1U << 3U, kNoParameters = 1U << 6U,
                         kConfigured = 1U << 7U;
  const bool is_ready = command_ && now_s >= ready_s_;
  std::vector<std::uint8_t> payload = {static_cast<std::uint8_t>(is_ready ? 0 : kWants)};
  put_u32(payload, static_cast<std::uint32_t>(static_cast<std::uint64_t>(now_s * 1000.0)));
  put_u16(payload, static_cast<std::uint16_t>(bearing_));
  payload.push_back(
      static_cast<std::uint8_t>(kCentred | kMotorOn | (command_ ? kConfigured : 0) | (is_ready ? 0 : kNoParameters)));
  return frame_from_head(SeanetMessage::kAlive, payload);
}

void MicronEmulator::turn() {
  const int step = command_->step;
  if ((command_->control & MicronCommand::kContinuous) != 0) {
    bearing_ = (bearing_ + step) % kMicronTurn;
    return;
  }
  // Places in the sector, clockwise from its left end.
  const int width = (command_->right - command_->left + kMicronTurn) % kMicronTurn;
  int place = (bearing_ - command_->left + kMicronTurn) % kMicronTurn;
  if (place > width) place = 0;  // it turns there first
  if (place + sense_ * step < 0 || place + sense_ * step > width) sense_ = -sense_;
  place = std::clamp(place + sense_ * step, 0, width);
  bearing_ = (command_->left + place) % kMicronTurn;
}

std::vector<std::uint8_t> MicronEmulator::line() {
  constexpr double kTick_s = 640e-9;
  constexpr std::uint8_t kEightBitStatus = 0x10;
  constexpr std::size_t kAroundSamples = 31;
  turn();
  const MicronCommand& c = *command_;
  const bool has_eight_bits = (c.control & MicronCommand::kEightBits) != 0;
  std::vector<std::uint8_t> samples =
      hear_(bearing_, c.bins, kAssumedSoundSpeed_m_s * (c.interval_640ns * kTick_s) / 2.0);
  assert(samples.size() == c.bins);
  if (!has_eight_bits) {
    for (std::size_t i = 0; i + 1 < samples.size(); i += 2) {
      samples[i / 2] = static_cast<std::uint8_t>((samples[i] & 0xf0U) | (samples[i + 1] >> 4U));
    }
    samples.resize(samples.size() / 2);
  }
  std::vector<std::uint8_t> payload;
  put_u16(payload, static_cast<std::uint16_t>(kAroundSamples + samples.size()));
  payload.push_back(c.head_type);
  payload.push_back(has_eight_bits ? kEightBitStatus : 0);
  payload.push_back(0);
  put_u16(payload, c.control);
  put_u16(payload, c.range_dm);
  put_u32(payload, 0);
  payload.push_back(c.gain);
  put_u16(payload, c.slope);
  payload.push_back(c.span);
  payload.push_back(c.low);
  for (const std::uint16_t word : {std::uint16_t{0}, c.interval_640ns, c.left, c.right}) put_u16(payload, word);
  payload.push_back(c.step);
  put_u16(payload, static_cast<std::uint16_t>(bearing_));
  put_u16(payload, static_cast<std::uint16_t>(samples.size()));
  payload.insert(payload.end(), samples.begin(), samples.end());
  return frame_from_head(SeanetMessage::kHeadData, payload);
}

double MicronEmulator::due_s() const {
  const double next_s = answers_.empty() ? alive_s_ : std::min(alive_s_, answers_.front().due_s);
  return std::max(next_s, silent_until_s_);
}

std::vector<std::uint8_t> MicronEmulator::send(double now_s) {
  if (now_s < due_s()) return {};
  if (answers_.empty() || answers_.front().due_s > now_s) {
    alive_s_ = now_s + kAlive_s;
    return faults_.pass(alive(now_s));
  }
  const Answer answer = std::move(answers_.front());
  answers_.pop_front();
  if (answer.is_ping) ++pings_;
  if (answer.is_ping && options_.stall_every > 0 && pings_ % options_.stall_every == 0) {
    silent_until_s_ = now_s + options_.stall_s;
    answers_.clear();
    command_.reset();
  }
  return faults_.pass(answer.frame);
}

}  // namespace pingvox
