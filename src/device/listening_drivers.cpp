#include "device/listening_drivers.hpp"

#include <fmt/core.h>

#include <utility>

#include "device/ping_fields.hpp"
#include "io/internal/ping_frame.hpp"
#include "io/internal/ping_json.hpp"

namespace pingvox {
namespace {

WebSocket socket_of(const PingViewer2Client::Settings& settings) {
  return {settings.host, settings.device.empty() ? "/ws" : "/ws?device_number=" + settings.device};
}

}  // namespace

void Ping360Listener::take(std::span<const std::uint8_t> frame) {
  if (ping360_ping(frame)) watch_.hear();
}

std::optional<std::vector<std::uint8_t>> Ping360Listener::message(double now_s) {
  constexpr std::uint16_t kProtocolVersion = 5;
  watch_.update(now_s);
  if (has_asked_ && !watch_.is_silent()) return std::nullopt;
  if (watch_.is_silent()) ++unanswered_;
  is_silent_ = watch_.is_silent();
  has_asked_ = true;
  watch_.wait(now_s);
  std::vector<std::uint8_t> wanted;
  put_u16(wanted, kProtocolVersion);
  return make_ping_frame(PingMessage::kGeneralRequest, kPingHost, kPingHost, wanted);
}

std::string Ping360Listener::problem() const {
  return is_silent_ ? "no pings: is another program driving the head?" : "";
}

PingViewer2Client::PingViewer2Client(Settings settings)
    : settings_(std::move(settings)), followed_(settings_.device), socket_(socket_of(settings_)) {}

void PingViewer2Client::connect() {
  socket_ = socket_of(settings_);
  watch_.begin();
  has_asked_ = false;
  problem_.clear();
}

std::span<const std::uint8_t> PingViewer2Client::frames_in(std::span<const std::uint8_t> bytes) {
  frames_.clear();
  socket_.take(bytes);
  while (const auto text = socket_.next_text()) {
    const auto ping = ping_in_json(*text);
    if (!ping) {
      leave_out(ping.error());
    } else if (*ping) {
      const PingJson& found = **ping;
      if (followed_.empty()) followed_ = found.device;
      if (found.device == followed_) {
        frames_.insert(frames_.end(), found.frame.begin(), found.frame.end());
      } else {
        leave_out(fmt::format("a ping of device {} instead of {}", found.device, followed_));
      }
    }
  }
  return frames_;
}

void PingViewer2Client::leave_out(const std::string& reason) {
  if (left_out_++ == 0) first_left_out_ = reason;
}

void PingViewer2Client::take(std::span<const std::uint8_t> frame) {
  if (ping360_ping(frame)) watch_.hear();
}

double PingViewer2Client::due_s() const {
  const bool has_to_send = !has_asked_ || socket_.has_answers() || !socket_.problem().empty();
  return has_to_send ? -std::numeric_limits<double>::infinity() : watch_.due_s();
}

std::optional<std::vector<std::uint8_t>> PingViewer2Client::message(double now_s) {
  watch_.update(now_s);
  if (!socket_.problem().empty()) {
    problem_ = socket_.problem();
  } else if (watch_.is_silent()) {
    problem_ = socket_.is_open() ? "no pings: is the sonar started in Ping Viewer?" : "no answer";
  }
  if (!problem_.empty()) return std::nullopt;
  if (!std::exchange(has_asked_, true)) return socket_.request();
  if (socket_.has_answers()) return socket_.take_answers();
  return std::nullopt;
}

}  // namespace pingvox
