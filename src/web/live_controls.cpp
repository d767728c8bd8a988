#include "web/live_controls.hpp"

#include <charconv>
#include <cmath>
#include <system_error>

#include "web/take_until.hpp"

namespace pingvox::web {
namespace {

std::optional<double> real_of(std::string_view text) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_whole = error == std::errc() && end == text.data() + text.size();
  return is_whole && std::isfinite(number) ? std::optional(number) : std::nullopt;
}

std::optional<ReceiverGain> gain_of(std::string_view text) {
  if (text == "low") return ReceiverGain::kLow;
  if (text == "normal") return ReceiverGain::kNormal;
  return text == "high" ? std::optional(ReceiverGain::kHigh) : std::nullopt;
}

/// "range=20&gain=high&step=1.8&sector=-60,60" or "sector=full"; nullopt: something else, or nothing.
std::optional<live_control::DriveHead> head_of(std::string_view query) {
  live_control::DriveHead head;
  if (query.empty()) return std::nullopt;
  while (!query.empty()) {
    std::string_view value = take_until('&', query);
    const std::string_view name = take_until('=', value);
    bool is_known = false;
    if (name == "range") is_known = (head.range_m = real_of(value)).has_value();
    if (name == "step") is_known = (head.step_deg = real_of(value)).has_value();
    if (name == "gain") is_known = (head.gain = gain_of(value)).has_value();
    if (name == "sector" && value == "full") is_known = head.is_full_turn = true;
    if (name == "sector" && value != "full") {
      const std::optional<double> from = real_of(take_until(',', value)), to = real_of(value);
      is_known = from && to;
      if (is_known) head.sector_deg = {*from, *to};
    }
    if (!is_known) return std::nullopt;
  }
  return head;
}

}  // namespace

std::optional<LiveControl> control_of(std::string_view path, std::string_view query) {
  if (path == "control/head") {
    const std::optional<live_control::DriveHead> head = head_of(query);
    return head ? std::optional<LiveControl>(*head) : std::nullopt;
  }
  if (!query.empty()) return std::nullopt;
  if (path == "control/recording/begin") return live_control::BeginRecording{};
  if (path == "control/recording/end") return live_control::EndRecording{};
  if (path == "control/map/new") return live_control::BeginNewMap{};
  return std::nullopt;
}

}  // namespace pingvox::web
