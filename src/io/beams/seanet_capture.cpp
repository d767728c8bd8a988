#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/beams/frame_log.hpp"
#include "io/beams/stream_reader.hpp"
#include "io/bytes/date.hpp"
#include "io/bytes/text.hpp"
#include "io/internal/seanet_frame.hpp"
#include "io/readers.hpp"

// Captures of the serial line of a SeaNet head: raw bytes, or UDP packets in hexadecimal text (docs/formats.md).
namespace pingvox {
namespace {

using Bytes = std::span<const std::uint8_t>;

/// Whether `bytes` hold a line of an imaging head.
bool holds_seanet_line(Bytes bytes) {
  FrameFinder finder(check_seanet_frame);
  finder.push(bytes);
  while (const auto frame = finder.next()) {
    if (seanet_line(frame->bytes)) return true;
  }
  return false;
}

/// Whether `bytes` hold a message of a head.
bool holds_seanet_frame(Bytes bytes) {
  FrameFinder finder(check_seanet_frame);
  finder.push(bytes);
  return finder.next().has_value();
}

/// A line "2017.11.02 08.58.46.723;10.3.0.40;4002;0F 11 0F".
struct Packet {
  double time_s;
  std::string_view from, hex;  ///< port, bytes
};

std::optional<Packet> packet_in(std::string_view line) {
  const auto time = cut_field(line, ';'), address = cut_field(line, ';'), port = cut_field(line, ';');
  if (!time || !address || !port || line.data() == nullptr || !count_in(*port)) return std::nullopt;
  const std::optional<double> time_s = date_time_s(*time);
  if (!time_s) return std::nullopt;
  return Packet{*time_s, *port, line};
}

constexpr std::array<int, 256> kHexDigits = [] {
  std::array<int, 256> digits = {};
  digits.fill(-1);
  for (int i = 0; i < 10; ++i) digits[static_cast<std::size_t>('0' + i)] = i;
  for (int i = 0; i < 6; ++i) {
    digits[static_cast<std::size_t>('a' + i)] = digits[static_cast<std::size_t>('A' + i)] = 10 + i;
  }
  return digits;
}();

/// Appends the bytes of "0F 11 0F"; false if the text is not of this form.
bool add_bytes_of(std::string_view hex, std::vector<std::uint8_t>& to) {
  hex = trim(hex);
  if (hex.empty()) return true;
  if (hex.size() % 3 != 2) return false;
  for (std::size_t i = 0; i < hex.size(); i += 3) {
    const int high = kHexDigits[static_cast<unsigned char>(hex[i])];
    const int low = kHexDigits[static_cast<unsigned char>(hex[i + 1])];
    if (high < 0 || low < 0 || (i + 2 < hex.size() && hex[i + 2] != ' ')) return false;
    to.push_back(static_cast<std::uint8_t>(high * 16 + low));
  }
  return true;
}

/// Port whose packets hold lines of an imaging head, or else other messages of one.
std::optional<std::string> sonar_port(Bytes beginning) {
  std::vector<std::pair<std::string, std::vector<std::uint8_t>>> ports;
  Lines lines(text_of(beginning));
  while (const auto line = lines.next()) {
    const std::optional<Packet> packet = packet_in(*line);
    if (!packet) continue;
    const auto is_same = [&](const auto& port) { return port.first == packet->from; };
    auto port = std::find_if(ports.begin(), ports.end(), is_same);
    if (port == ports.end()) port = ports.insert(port, {std::string(packet->from), {}});
    add_bytes_of(packet->hex, port->second);
  }
  for (const auto& [port, bytes] : ports) {
    if (holds_seanet_line(bytes)) return port;
  }
  // A head that does not scan yet.
  for (const auto& [port, bytes] : ports) {
    if (holds_seanet_frame(bytes)) return port;
  }
  return std::nullopt;
}

class UdpCapture : public FrameContainer {
 public:
  UdpCapture(StreamReader reader, std::string port) : reader_(std::move(reader)), port_(std::move(port)) {}

  const std::string& name() const override { return reader_.name(); }
  std::optional<double> share_read() const override { return reader_.share_read(); }

  Result<std::optional<Piece>> next() override {
    for (;;) {
      const std::uint64_t at = reader_.position();
      const Result<std::optional<std::string_view>> line = reader_.next_line();
      if (!line) return tl::unexpected(line.error());
      if (!*line) return std::nullopt;
      if (trim(**line).empty()) continue;
      const std::optional<Packet> packet = packet_in(**line);
      if (packet && packet->from != port_) continue;
      bytes_.clear();
      if (!packet || !add_bytes_of(packet->hex, bytes_)) {
        add_damage(damage_, reader_.line_has_end() ? "line that is not a packet" : FrameFinder::kCutOff, at);
        continue;
      }
      const auto before = static_cast<std::uint64_t>(packet->hex.data() - (*line)->data());
      return Piece{bytes_, at + before, 3, packet->time_s, 0.0};
    }
  }

 private:
  StreamReader reader_;
  std::string port_;
  std::vector<std::uint8_t> bytes_;  ///< of the last packet
};

}  // namespace

bool looks_like_seanet_capture(Bytes beginning) {
  // A frame has at most 4096 bytes: if the capture begins within one, the next one is complete.
  constexpr std::size_t kTwoFrames = 8192;
  return holds_seanet_line(beginning.first(std::min(beginning.size(), kTwoFrames)));
}

Result<std::unique_ptr<BeamSource>> open_seanet_capture(ByteStream stream, Damage damage) {
  return beams_of(raw_capture(std::move(stream)), seanet_protocol(), damage);
}

bool looks_like_udp_capture(Bytes beginning) {
  // If the capture begins within a line, the next one is whole.
  Lines lines(text_of(beginning));
  const auto first = lines.next(), second = lines.next();
  return (first && packet_in(*first)) || (second && packet_in(*second));
}

Result<std::unique_ptr<BeamSource>> open_udp_capture(ByteStream stream, Damage damage) {
  std::optional<std::string> port = sonar_port(stream.beginning());
  if (!port) {
    return fail(
        Error::Code::kUnsupported,
        fmt::format("{}: is a capture of UDP packets, but the first ones are not of a SeaNet sonar", stream.name()));
  }
  return beams_of(std::make_unique<UdpCapture>(StreamReader(std::move(stream)), *std::move(port)), seanet_protocol(),
                  damage);
}

}  // namespace pingvox
