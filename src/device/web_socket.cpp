#include "device/web_socket.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>

namespace pingvox {
namespace {

/// The example of RFC 6455, with the answer that only a server that knows the protocol gives. It need not be a secret:
/// a random one is for browsers, whose scripts choose what is sent.
constexpr std::string_view kKey = "dGhlIHNhbXBsZSBub25jZQ==", kAccept = "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=";

/// Of a message; a ping has some kilobytes.
constexpr std::size_t kMaxMessage = std::size_t{1} << 20, kMaxHeader = 16'384;

constexpr unsigned kContinuation = 0, kText = 1, kBinary = 2, kClose = 8, kPing = 9, kPong = 10;

std::string in_lower_case(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

std::string_view without_blanks(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

/// The value of a line of a header; empty: there is none.
std::string_view header_value(std::string_view header, std::string_view name) {
  while (!header.empty()) {
    const std::size_t end = std::min(header.find("\r\n"), header.size());
    const std::string_view line = header.substr(0, end);
    const std::size_t colon = line.find(':');
    if (colon != std::string_view::npos && in_lower_case(line.substr(0, colon)) == name) {
      return without_blanks(line.substr(colon + 1));
    }
    header.remove_prefix(std::min(end + 2, header.size()));
  }
  return {};
}

/// A received line, for a message.
std::string shown(std::string_view line) {
  constexpr std::size_t kMaxLength = 60;
  std::string text(line.substr(0, kMaxLength));
  for (char& c : text) {
    if (c < ' ' || c > '~') c = '?';
  }
  return text;
}

}  // namespace

std::vector<std::uint8_t> WebSocket::request() const {
  const std::string text = fmt::format(
      "GET {} HTTP/1.1\r\nHost: {}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: {}\r\n"
      "Sec-WebSocket-Version: 13\r\n\r\n",
      path_, host_, kKey);
  return {text.begin(), text.end()};
}

void WebSocket::take(std::span<const std::uint8_t> bytes) {
  if (!problem_.empty()) return;
  buffer_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  while (problem_.empty() && (is_open_ ? read_frame() : read_agreement())) {
  }
}

std::optional<std::string> WebSocket::next_text() {
  if (texts_.empty()) return std::nullopt;
  std::string text = std::move(texts_.front());
  texts_.pop_front();
  return text;
}

bool WebSocket::end(std::string problem) {
  problem_ = std::move(problem);
  return false;
}

bool WebSocket::read_agreement() {
  const std::size_t end_of_header = buffer_.find("\r\n\r\n");
  if (end_of_header == std::string::npos) return buffer_.size() > kMaxHeader ? end("is not a web server") : false;
  const std::string_view header = std::string_view(buffer_).substr(0, end_of_header);
  const std::string_view line = header.substr(0, header.find("\r\n"));
  if (!line.starts_with("HTTP/1.1 101")) return end(fmt::format("answered '{}'", shown(line)));
  if (header_value(header, "sec-websocket-accept") != kAccept) return end("is not a WebSocket");
  buffer_.erase(0, end_of_header + 4);
  is_open_ = true;
  return true;
}

bool WebSocket::read_frame() {
  constexpr unsigned kLast = 0x80, kExtensions = 0x70, kOpcode = 0x0f, kMasked = 0x80, kLength = 0x7f;
  constexpr std::size_t kShort = 126, kLong = 127;
  const auto byte = [&](std::size_t i) { return static_cast<unsigned>(static_cast<unsigned char>(buffer_[i])); };
  if (buffer_.size() < 2) return false;
  const unsigned first = byte(0), second = byte(1);
  std::size_t length = second & kLength;
  const std::size_t more = length == kShort ? 2 : length == kLong ? 8 : 0;
  if (buffer_.size() < 2 + more) return false;
  if (more > 0) {
    std::uint64_t long_length = 0;
    for (std::size_t i = 0; i < more; ++i) long_length = long_length << 8U | byte(2 + i);
    if (long_length > kMaxMessage) return end("sent a message of more than a megabyte");
    length = static_cast<std::size_t>(long_length);
  }
  const unsigned opcode = first & kOpcode;
  const bool is_last = (first & kLast) != 0, is_control = opcode >= kClose;
  const bool is_right = (first & kExtensions) == 0 && (second & kMasked) == 0 && (opcode <= kBinary || is_control) &&
                        opcode <= kPong && (!is_control || (is_last && more == 0));
  if (!is_right || message_.size() + length > kMaxMessage) return end("sent invalid WebSocket data");
  if (buffer_.size() < 2 + more + length) return false;
  const std::string payload = buffer_.substr(2 + more, length);
  buffer_.erase(0, 2 + more + length);
  take_frame(opcode, is_last, payload);
  return true;
}

void WebSocket::take_frame(unsigned opcode, bool is_last, std::string_view payload) {
  if (opcode == kClose) {
    end("closed by the server");
  } else if (opcode == kPing) {
    // Clients mask what they send, with any four bytes.
    constexpr std::array<std::uint8_t, 4> kMask = {0x37, 0xfa, 0x21, 0x3d};
    answers_.push_back(static_cast<std::uint8_t>(0x80U | kPong));
    answers_.push_back(static_cast<std::uint8_t>(0x80U | payload.size()));
    answers_.insert(answers_.end(), kMask.begin(), kMask.end());
    for (std::size_t i = 0; i < payload.size(); ++i) {
      answers_.push_back(static_cast<std::uint8_t>(static_cast<unsigned char>(payload[i]) ^ kMask[i % kMask.size()]));
    }
  } else if (opcode <= kBinary) {
    if (opcode != kContinuation) {
      message_.clear();
      is_text_ = opcode == kText;
    }
    message_ += payload;
    if (is_last && is_text_) texts_.push_back(std::move(message_));
    if (is_last) message_.clear();
  }
}

}  // namespace pingvox
