#include "device/ping360_driver.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <iterator>
#include <string_view>
#include <utility>

#include "base/option_errors.hpp"
#include "device/ping_fields.hpp"
#include "io/internal/ping_frame.hpp"
#include "pingvox/sonar/device_profile.hpp"

namespace pingvox {
namespace {

constexpr std::uint16_t kFrequency_khz = 750;

/// The answer of a head to a message that it refuses: the message's number, then text.
std::string text_of_nack(std::span<const std::uint8_t> payload) {
  std::string text;
  for (std::size_t i = sizeof(std::uint16_t); i < payload.size(); ++i) {
    const bool is_printable = payload[i] >= ' ' && payload[i] <= '~';
    if (is_printable) text += static_cast<char>(payload[i]);
  }
  return text.empty() ? "without a reason" : text;
}

}  // namespace

Ping360Sampling ping360_sampling(double range_m) {
  constexpr double kTick_s = 25e-9, kMaxSamples = 1200.0, kMinPeriod = 80.0;
  const double ticks = 2.0 * range_m / (kAssumedSoundSpeed_m_s * kTick_s);  // to the range and back
  const double samples = std::min(kMaxSamples, std::floor(ticks / kMinPeriod));
  const double period = std::floor(ticks / samples);
  const double period_s = period * kTick_s;
  const double max_us = std::min(500.0, std::floor(64e6 * period_s));
  const double pulse_us = std::max(std::round(8000.0 * range_m / kAssumedSoundSpeed_m_s), 2.5e6 * period_s);
  return {static_cast<std::uint16_t>(samples), static_cast<std::uint16_t>(period),
          static_cast<std::uint16_t>(std::clamp(pulse_us, 5.0, max_us))};
}

Result<void> Ping360Settings::validate() const {
  OptionErrors errors;
  errors.require_within("range_m", range_m, kRanges_m.low, kRanges_m.high);
  errors.require_within("step_grad", step_grad, 1, 20);
  errors.require_within("timeout_s", timeout_s, kHeadTimeouts_s.low, kHeadTimeouts_s.high);
  if (sector) {
    errors.require_within("first_grad", sector->first_grad, 0, kTurn_grad - 1);
    errors.require_within("width_grad", sector->width_grad, 1, kTurn_grad - 1);
  }
  return errors.result("ping360");
}

Ping360Driver::Ping360Driver(const Ping360Settings& settings)
    : settings_(settings),
      sampling_(ping360_sampling(settings.range_m)),
      angle_grad_(settings.sector ? settings.sector->first_grad : 0) {
  assert(settings.validate());
}

void Ping360Driver::drive(const Ping360Settings& settings) {
  assert(settings.validate());
  next_settings_ = settings;
}

void Ping360Driver::take_settings() {
  const bool has_same_sector = next_settings_->sector == settings_.sector;
  settings_ = *std::exchange(next_settings_, std::nullopt);
  sampling_ = ping360_sampling(settings_.range_m);
  // A late answer to the last request has its settings.
  asked_grad_ = asked_before_grad_ = std::nullopt;
  if (has_same_sector) return;
  place_grad_ = 0;
  sense_ = 1;
  if (settings_.sector) angle_grad_ = settings_.sector->first_grad;
}

void Ping360Driver::connect() {
  is_known_ = is_waiting_ = false;
  unanswered_in_a_row_ = 0;
  refusal_.clear();
}

bool Ping360Driver::is_lost() const {
  constexpr int kMaxUnanswered = 3;
  return unanswered_in_a_row_ >= kMaxUnanswered;
}

std::string Ping360Driver::problem() const {
  return refusal_.empty() ? "no answer" : fmt::format("refused: {}", refusal_);
}

void Ping360Driver::take(std::span<const std::uint8_t> frame) {
  constexpr std::uint8_t kPing360 = 2;
  const PingMessage message = ping_message(frame);
  if (message == PingMessage::kNack) refusal_ = text_of_nack(ping_payload(frame));
  if (message == PingMessage::kDeviceInformation && !is_known_) {
    const std::span<const std::uint8_t> payload = ping_payload(frame);
    if (payload.empty() || payload[0] != kPing360) return;
    is_known_ = true;
    is_waiting_ = false;
    unanswered_in_a_row_ = 0;
  }
  if (message == PingMessage::kDeviceData && is_known_) {
    const std::optional<Ping360Ping> ping = ping360_ping(frame);
    // A doubled or late answer is of another angle.
    if (!ping || ping->angle_grad != angle_grad_) return;
    is_waiting_ = false;
    unanswered_in_a_row_ = 0;
    refusal_.clear();
    turn();
  }
}

std::optional<std::string> Ping360Driver::contradiction(std::span<const std::uint8_t> frame) const {
  const std::optional<Ping360Ping> ping = ping360_ping(frame);
  if (!ping) return std::nullopt;
  if (ping_message(frame) != PingMessage::kDeviceData) return "a ping requested by another host";
  if (ping->angle_grad != asked_grad_ && ping->angle_grad != asked_before_grad_) {
    return asked_grad_ ? fmt::format("angle {} instead of {}", ping->angle_grad, *asked_grad_)
                       : std::string("an unrequested ping");
  }
  struct Value {
    std::string_view name;
    std::size_t is, asked;
  };
  for (const Value& value : {Value{"gain", ping->gain, static_cast<std::size_t>(settings_.gain)},
                             Value{"sample_period", ping->period_25ns, sampling_.period_25ns},
                             Value{"transmit_frequency", ping->frequency_khz, kFrequency_khz},
                             Value{"number_of_samples", ping->samples, sampling_.samples},
                             Value{"data_length", ping->data.size(), sampling_.samples}}) {
    if (value.is != value.asked) {
      return fmt::format("{} {} instead of {}", value.name, value.is, value.asked);
    }
  }
  return std::nullopt;
}

void Ping360Driver::expect_rest(double until_s) {
  rest_until_s_ = until_s;
}

std::optional<std::vector<std::uint8_t>> Ping360Driver::message(double now_s) {
  if (is_waiting_ && now_s < due_s()) return std::nullopt;
  if (is_waiting_) {
    ++unanswered_;
    ++unanswered_in_a_row_;
  }
  if (next_settings_) take_settings();
  is_waiting_ = true;
  deadline_s_ = now_s + settings_.timeout_s;
  rest_until_s_ = std::numeric_limits<double>::infinity();
  if (is_known_) {
    if (asked_grad_ != angle_grad_) asked_before_grad_ = std::exchange(asked_grad_, angle_grad_);
    return ping();
  }
  std::vector<std::uint8_t> wanted;
  put_u16(wanted, static_cast<std::uint16_t>(PingMessage::kDeviceInformation));
  // Another host may have left the head scanning (auto_transmit), which only this ends.
  std::vector<std::uint8_t> messages = motor_off();
  std::ranges::copy(make_ping_frame(PingMessage::kGeneralRequest, kPingHost, kPingHead, wanted),
                    std::back_inserter(messages));
  return messages;
}

std::vector<std::uint8_t> Ping360Driver::motor_off() {
  return make_ping_frame(PingMessage::kMotorOff, kPingHost, kPingHead, {});
}

void Ping360Driver::turn() {
  if (!settings_.sector) {
    angle_grad_ = (angle_grad_ + settings_.step_grad) % kTurn_grad;
    return;
  }
  const auto& [first_grad, width_grad] = *settings_.sector;
  const auto is_inside = [width = width_grad](int place) { return place >= 0 && place <= width; };
  if (!is_inside(place_grad_ + sense_ * settings_.step_grad)) sense_ = -sense_;
  // A sector narrower than a step is one angle.
  if (const int next = place_grad_ + sense_ * settings_.step_grad; is_inside(next)) place_grad_ = next;
  angle_grad_ = (first_grad + place_grad_) % kTurn_grad;
}

std::vector<std::uint8_t> Ping360Driver::ping() const {
  constexpr std::uint8_t kMode = 1;
  std::vector<std::uint8_t> payload = {kMode, static_cast<std::uint8_t>(settings_.gain)};
  put_u16(payload, static_cast<std::uint16_t>(angle_grad_));
  put_u16(payload, sampling_.transmit_us);
  put_u16(payload, sampling_.period_25ns);
  put_u16(payload, kFrequency_khz);
  put_u16(payload, sampling_.samples);
  payload.push_back(1);  // transmit
  payload.push_back(0);
  return make_ping_frame(PingMessage::kTransducer, kPingHost, kPingHead, payload);
}

}  // namespace pingvox
