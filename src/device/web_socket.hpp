#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pingvox {

/// The client's end of a WebSocket (RFC 6455) that receives texts. It has no line of its own: the caller carries the
/// bytes.
class WebSocket {
 public:
  /// @param host  for the request, as in "192.168.2.2:6060"
  /// @param path  as in "/ws?device_number=1"
  WebSocket(std::string host, std::string path) : host_(std::move(host)), path_(std::move(path)) {}

  /// The bytes to begin with.
  std::vector<std::uint8_t> request() const;
  /// Takes bytes of the server.
  void take(std::span<const std::uint8_t> bytes);
  /// The next text; nullopt: none is whole.
  std::optional<std::string> next_text();
  /// The bytes to answer pings of the server with, once.
  std::vector<std::uint8_t> take_answers() { return std::exchange(answers_, {}); }
  bool has_answers() const { return !answers_.empty(); }

  /// Whether the server agreed.
  bool is_open() const { return is_open_; }
  /// Why it has ended: the server closed it, refused, or sent invalid data. Empty: it has not.
  const std::string& problem() const { return problem_; }

 private:
  /// @return whether more may be in the buffer
  bool read_agreement();
  bool read_frame();
  void take_frame(unsigned opcode, bool is_last, std::string_view payload);
  bool end(std::string problem);

  std::string host_, path_;
  std::string buffer_, message_;
  bool is_open_ = false, is_text_ = false;
  std::deque<std::string> texts_;
  std::vector<std::uint8_t> answers_;
  std::string problem_;
};

}  // namespace pingvox
