#include "device/micron_driver.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include "base/option_errors.hpp"
#include "device/micron_command.hpp"
#include "io/internal/seanet_frame.hpp"
#include "pingvox/sonar/beam.hpp"
#include "pingvox/sonar/device_profile.hpp"

namespace pingvox {
namespace {

std::vector<std::uint8_t> ask(SeanetMessage message) {
  return make_seanet_frame(message, SeanetSender::kHost, {});
}

std::vector<std::uint8_t> ask_for_line() {
  // The host's time, which heads do not use.
  return make_seanet_frame(SeanetMessage::kSendData, SeanetSender::kHost, std::array<std::uint8_t, 4>{});
}

/// A head may go a step beyond the ends, or stand there.
bool is_in_sector(const MicronSettings::Sector& sector, int step, int bearing) {
  const auto clockwise = [](int from, int to) { return ((to - from) % kMicronTurn + kMicronTurn) % kMicronTurn; };
  const int width = clockwise(sector.left, sector.right);
  return clockwise(sector.left - step, bearing) <= width + 2 * step;
}

}  // namespace

MicronSampling micron_sampling(double range_m) {
  constexpr double kTick_s = 640e-9, kMaxBins = 400.0, kMinInterval = 5.0;
  const double ticks = 2.0 * range_m / (kAssumedSoundSpeed_m_s * kTick_s);  // to the range and back
  const double interval = std::max(kMinInterval, std::ceil(ticks / kMaxBins));
  return {static_cast<std::uint16_t>(std::clamp(std::round(ticks / interval), 1.0, kMaxBins)),
          static_cast<std::uint16_t>(interval)};
}

Result<void> MicronSettings::validate() const {
  OptionErrors errors;
  errors.require_within("range_m", range_m, kRanges_m.low, kRanges_m.high);
  errors.require_within("step", step, 1, 255);
  errors.require_within("timeout_s", timeout_s, kHeadTimeouts_s.low, kHeadTimeouts_s.high);
  if (sector) {
    errors.require_within("left", sector->left, 0, kMicronTurn - 1);
    errors.require_within("right", sector->right, 0, kMicronTurn - 1);
  }
  return errors.result("micron");
}

MicronDriver::MicronDriver(const MicronSettings& settings) : settings_(settings) {
  assert(settings.validate());
}

void MicronDriver::drive(const MicronSettings& settings) {
  assert(settings.validate());
  next_settings_ = settings;
}

void MicronDriver::connect() {
  enter(State::kLooking);
}

bool MicronDriver::is_lost() const {
  constexpr int kMaxUnanswered = 3;
  return unanswered_in_a_row_ >= kMaxUnanswered;
}

void MicronDriver::enter(State state) {
  state_ = state;
  is_waiting_ = false;
  unanswered_in_a_row_ = 0;
  lines_left_ = 0;
}

void MicronDriver::take(std::span<const std::uint8_t> frame) {
  if (seanet_sender(frame) == SeanetSender::kHost) return;  // an echo of our own
  const SeanetMessage message = seanet_message(frame);
  if (message == SeanetMessage::kAlive) {
    constexpr std::size_t kHeadInfo = 20;
    constexpr std::uint8_t kNoParameters = 1U << 6U;
    const bool wants_parameters = (frame[kHeadInfo] & kNoParameters) != 0;
    if (state_ == State::kLooking) return enter(State::kAsking);
    // One from before they were sent does not confirm them.
    if (state_ == State::kConfiguring && is_waiting_ && !wants_parameters) return enter(State::kScanning);
    // It restarted.
    if (state_ == State::kScanning && wants_parameters) return enter(State::kConfiguring);
  }
  if (message == SeanetMessage::kVersionData && state_ == State::kLooking) return enter(State::kAsking);
  if (message == SeanetMessage::kUserData && state_ == State::kAsking) {
    constexpr std::size_t kDuplex = 146, kDstSize = 264;
    lines_of_request_ = frame.size() > kDuplex && frame[kDuplex] == 0 ? 2 : 1;
    is_dst_ = frame.size() >= kDstSize;
    return enter(State::kConfiguring);
  }
  if (message == SeanetMessage::kHeadData && state_ == State::kScanning) {
    constexpr std::uint8_t kNoPower = 1, kLostStep = 2;
    const auto line = seanet_line(frame);
    if (line && (line->status & (kNoPower | kLostStep)) != 0) return enter(State::kConfiguring);
    unanswered_in_a_row_ = 0;
    if (lines_left_ > 0 && --lines_left_ == 0) is_waiting_ = false;
  }
}

std::optional<std::string> MicronDriver::contradiction(std::span<const std::uint8_t> frame) const {
  constexpr double kTolerance = 0.1;
  if (seanet_sender(frame) == SeanetSender::kHost) return std::nullopt;
  const auto line = seanet_line(frame);
  if (!line) return std::nullopt;
  const tl::expected<Beam, std::string> beam = beam_of(*line, 0.0);
  if (!beam) return std::nullopt;
  const auto differs = [](double is, double asked) { return std::abs(is - asked) > kTolerance * asked; };
  const MicronSampling asked = micron_sampling(settings_.range_m);
  const auto bins = beam->intensities.size();
  if (differs(static_cast<double>(bins), asked.bins)) {
    return fmt::format("{} bins instead of {}", bins, asked.bins);
  }
  const double range_m = static_cast<double>(bins) * beam->bin_length_m;
  if (differs(range_m, settings_.range_m)) {
    return fmt::format("a range of {:.4g} m instead of {:.4g} m", range_m, settings_.range_m);
  }
  if (settings_.sector && !is_in_sector(*settings_.sector, settings_.step, line->bearing)) {
    return fmt::format("bearing {} instead of {} to {}", line->bearing, settings_.sector->left,
                       settings_.sector->right);
  }
  return std::nullopt;
}

void MicronDriver::expect_rest(double until_s) {
  // A head that finds its centre is not to begin again.
  if (state_ == State::kScanning) rest_until_s_ = until_s;
}

std::optional<std::vector<std::uint8_t>> MicronDriver::message(double now_s) {
  // A head sends mtAlive once a second; it finds its centre before it takes parameters.
  constexpr double kAnswer_s = 1.0, kCentre_s = 10.0;
  if (is_waiting_ && now_s < due_s()) return std::nullopt;
  if (is_waiting_ && state_ == State::kAsking) {
    enter(State::kConfiguring);  // not all heads answer
  } else if (is_waiting_) {
    ++unanswered_;
    ++unanswered_in_a_row_;
  }
  if (next_settings_) {
    settings_ = *std::exchange(next_settings_, std::nullopt);
    if (state_ == State::kScanning) enter(State::kConfiguring);
  }
  is_waiting_ = true;
  rest_until_s_ = std::numeric_limits<double>::infinity();
  switch (state_) {
    case State::kLooking:
      // A serial-to-UDP converter learns here where to send the bytes of the head.
      deadline_s_ = now_s + std::max(settings_.timeout_s, kAnswer_s);
      return ask(SeanetMessage::kSendVersion);
    case State::kAsking:
      deadline_s_ = now_s + kAnswer_s;
      return ask(SeanetMessage::kSendUserData);
    case State::kConfiguring:
      deadline_s_ = now_s + kCentre_s;
      return head_command();
    case State::kScanning:
      deadline_s_ = now_s + settings_.timeout_s;
      lines_left_ = lines_of_request_;
      return ask_for_line();
  }
  assert(false);
  return std::nullopt;
}

std::vector<std::uint8_t> MicronDriver::head_command() const {
  constexpr std::array<std::uint8_t, 3> kGains = {42, 84, 126};  // 20, 40 and 60 %
  constexpr double kFrequency_hz = 675e3;
  constexpr std::uint16_t kSlope = 125;
  const auto [bins, interval_640ns] = micron_sampling(settings_.range_m);
  MicronCommand command;
  command.pulse_us = static_cast<std::uint16_t>(std::clamp((settings_.range_m + 10.0) * 2.5, 37.0, 350.0));
  command.range_dm = static_cast<std::uint16_t>(std::lround(10.0 * settings_.range_m));
  command.gain = kGains[static_cast<std::size_t>(settings_.gain)];
  command.step = static_cast<std::uint8_t>(settings_.step);
  command.bins = bins;
  command.interval_640ns = interval_640ns;
  if (!is_dst_) {
    command.head_type = MicronCommand::kImaging;
    command.frequency_hz = kFrequency_hz;
    command.slope = kSlope;
  }
  if (settings_.sector) {
    command.control = static_cast<std::uint16_t>(command.control & ~unsigned{MicronCommand::kContinuous});
    command.left = static_cast<std::uint16_t>(settings_.sector->left);
    command.right = static_cast<std::uint16_t>(settings_.sector->right);
  }
  return frame_of(command);
}

}  // namespace pingvox
