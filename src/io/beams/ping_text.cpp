#include <algorithm>
#include <array>
#include <charconv>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/beams/frame_log.hpp"
#include "io/beams/stream_reader.hpp"
#include "io/bytes/text.hpp"
#include "io/readers.hpp"

// Pings of a Ping360 as Blue Robotics' Python library prints its PingMessage (docs/formats.md). They are put together
// to frames again, so that their checksums count.
namespace pingvox {
namespace {

struct PrintedField {
  std::string_view name;
  std::size_t size;  ///< in the frame [bytes]
};

constexpr std::array kDeviceData = {PrintedField{"mode", 1},
                                    PrintedField{"gain_setting", 1},
                                    PrintedField{"angle", 2},
                                    PrintedField{"transmit_duration", 2},
                                    PrintedField{"sample_period", 2},
                                    PrintedField{"transmit_frequency", 2},
                                    PrintedField{"number_of_samples", 2},
                                    PrintedField{"data_length", 2}};
constexpr std::array kAutoDeviceData = {PrintedField{"mode", 1},
                                        PrintedField{"gain_setting", 1},
                                        PrintedField{"angle", 2},
                                        PrintedField{"transmit_duration", 2},
                                        PrintedField{"sample_period", 2},
                                        PrintedField{"transmit_frequency", 2},
                                        PrintedField{"start_angle", 2},
                                        PrintedField{"stop_angle", 2},
                                        PrintedField{"num_steps", 1},
                                        PrintedField{"delay", 1},
                                        PrintedField{"number_of_samples", 2},
                                        PrintedField{"data_length", 2}};

constexpr std::uint64_t kStart = 0x5242;  // "BR"

/// The fields before the samples; empty: another message.
std::span<const PrintedField> fields_of(std::uint64_t id) {
  if (id == 2300) return kDeviceData;
  if (id == 2301) return kAutoDeviceData;
  return {};
}

/// Removes `label` from the front of `text`; false: it begins with something else.
bool cut_label(std::string_view& text, std::string_view label) {
  if (!text.starts_with(label)) return false;
  text = trim(text.substr(label.size()));
  return true;
}

/// The whole number behind a label.
std::optional<std::uint64_t> number_behind(std::string_view text, std::string_view label) {
  const std::size_t at = text.find(label);
  if (at == std::string_view::npos) return std::nullopt;
  text.remove_prefix(at + label.size());
  const std::optional<std::string_view> word = cut_word(text);
  return word ? count_in(*word) : std::nullopt;
}

/// Appends a number, little-endian; false: it does not fit.
bool append(std::vector<std::uint8_t>& bytes, std::optional<std::uint64_t> value, std::size_t size) {
  if (!value || *value >> (8 * size) != 0) return false;
  for (std::size_t i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>(*value >> (8 * i)));
  return true;
}

/// Appends the bytes of "['0x4c', '0x9']"; false: it is something else.
bool append_samples(std::vector<std::uint8_t>& bytes, std::string_view list) {
  if (!list.starts_with('[') || !list.ends_with(']') || list.size() < 2) return false;
  list = list.substr(1, list.size() - 2);
  while (const std::optional<std::string_view> word = cut_word(list)) {
    if (word->size() < 5 || !word->starts_with("'0x") || !word->ends_with('\'')) return false;
    const char* const end = word->data() + word->size() - 1;
    std::uint8_t value = 0;
    const auto [stop, error] = std::from_chars(word->data() + 3, end, value, 16);
    if (error != std::errc{} || stop != end) return false;
    bytes.push_back(value);
  }
  return true;
}

class PrintedFrames final : public FrameContainer {
 public:
  explicit PrintedFrames(StreamReader reader) : reader_(std::move(reader)) {}

  const std::string& name() const override { return reader_.name(); }
  std::optional<double> share_read() const override { return reader_.share_read(); }
  BeamClock clock() const override { return BeamClock::kNone; }

  Result<std::optional<Piece>> next() override {
    for (;;) {
      const std::uint64_t at = reader_.position();
      const Result<std::optional<std::string_view>> line = reader_.next_line();
      if (!line) return tl::unexpected(line.error());
      if (!*line) {
        if (std::exchange(in_frame_, false)) add_damage(damage_, FrameFinder::kCutOff, frame_at_);
        return std::nullopt;
      }
      switch (take(trim(**line), at)) {
        case Line::kOther:
          break;
        case Line::kDamaged:
          in_frame_ = false;
          add_damage(damage_, "line that cannot be read", at);
          break;
        case Line::kLast: {
          in_frame_ = false;
          const double time_s = static_cast<double>(bytes_before_) * kSerialByte_s;
          bytes_before_ += bytes_.size();
          return Piece{bytes_, frame_at_, 0, time_s, kSerialByte_s};
        }
      }
    }
  }

 private:
  enum class Line { kOther, kDamaged, kLast };

  Line take(std::string_view line, std::uint64_t at) {
    if (cut_label(line, "ID:")) return begin_frame(line, at);
    if (!in_frame_) return Line::kOther;
    if (cut_label(line, "Header:")) {
      // Where the message began already.
      const bool is_read = bytes_.empty() && append(bytes_, kStart, 2) &&
                           append(bytes_, number_behind(line, "payload_length: "), 2) && append(bytes_, id_, 2) &&
                           append(bytes_, number_behind(line, "src_device_id: "), 1) &&
                           append(bytes_, number_behind(line, "dst_device_id: "), 1);
      return is_read ? Line::kOther : Line::kDamaged;
    }
    if (cut_label(line, "- ")) return take_field(line) ? Line::kOther : Line::kDamaged;
    if (!cut_label(line, "Checksum:")) return Line::kOther;
    const std::optional<std::string_view> sum = cut_word(line);
    const bool is_whole = has_samples_ && sum && append(bytes_, count_in(*sum), 2);
    return is_whole ? Line::kLast : Line::kDamaged;
  }

  Line begin_frame(std::string_view id, std::uint64_t at) {
    if (in_frame_) add_damage(damage_, "ping that breaks off", frame_at_);
    const std::optional<std::string_view> word = cut_word(id);
    const std::optional<std::uint64_t> number = word ? count_in(*word) : std::nullopt;
    if (!number) return Line::kDamaged;
    id_ = *number;
    in_frame_ = !fields_of(id_).empty();
    frame_at_ = at;
    bytes_.clear();
    fields_ = 0;
    has_samples_ = false;
    return Line::kOther;
  }

  /// "angle: 150", in the order of the frame.
  bool take_field(std::string_view line) {
    const std::span<const PrintedField> fields = fields_of(id_);
    if (bytes_.empty() || has_samples_) return false;
    if (fields_ == fields.size()) {
      has_samples_ = true;
      return cut_label(line, "data:") && append_samples(bytes_, line);
    }
    const auto& [name, size] = fields[fields_++];
    return cut_label(line, name) && cut_label(line, ":") && append(bytes_, count_in(line), size);
  }

  StreamReader reader_;
  std::vector<std::uint8_t> bytes_;  ///< of the frame, as far as it was read
  std::uint64_t bytes_before_ = 0;   ///< of all frames before it
  std::uint64_t id_ = 0;             ///< of the message
  std::uint64_t frame_at_ = 0;       ///< place of its first line in the file
  std::size_t fields_ = 0;           ///< that were read of it
  bool in_frame_ = false, has_samples_ = false;
};

}  // namespace

bool looks_like_ping_text(std::span<const std::uint8_t> beginning) {
  constexpr std::size_t kSearched = 1024;
  const std::string_view text = text_of(beginning.first(std::min(beginning.size(), kSearched)));
  const auto begins_line = [&](std::string_view words) {
    return text.starts_with(words) || text.find(std::string("\n").append(words)) != std::string_view::npos;
  };
  return begins_line("ID: 2300 - device_data") || begins_line("ID: 2301 - auto_device_data");
}

Result<std::unique_ptr<BeamSource>> open_ping_text(ByteStream stream, Damage damage) {
  return beams_of(std::make_unique<PrintedFrames>(StreamReader(std::move(stream))), ping_protocol(), damage);
}

}  // namespace pingvox
