#include <fmt/core.h>

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/beams/stream_reader.hpp"
#include "io/bytes/text.hpp"
#include "io/internal/frame_finder.hpp"
#include "io/readers.hpp"

// The imaging sonar of the Ictineu, a MiniKing, as text: a beam in each line (docs/formats.md).
namespace pingvox {
namespace {

constexpr std::size_t kIctineuBins = 500;
constexpr double kIctineuBinLength_m = 0.1;

bool is_comment_or_blank(std::string_view line) {
  const std::string_view content = trim(line);
  return content.empty() || content.front() == '%';
}

/// Parses a line; the error is the reason why it is invalid.
tl::expected<Beam, std::string> ictineu_beam_in(std::string_view line) {
  // The second number is the same time, of the day.
  const auto time_s = number_in(cut_word(line).value_or("")), of_day_ms = number_in(cut_word(line).value_or("")),
             angle_rad = number_in(cut_word(line).value_or(""));
  if (!time_s || !of_day_ms || !angle_rad) return tl::unexpected(std::string("does not begin with times and an angle"));
  Beam beam;
  beam.time_s = *time_s;
  // The transducer's angle counts clockwise, as in the hits.
  beam.bearing_rad = wrap_bearing(-*angle_rad);
  beam.bin_length_m = kIctineuBinLength_m;
  beam.intensities.reserve(kIctineuBins);
  while (const auto word = cut_word(line)) {
    const auto sample = count_in(*word);
    if (!sample || *sample > 255) return tl::unexpected(fmt::format("\"{}\" is not a sample", printable(*word)));
    beam.intensities.push_back(static_cast<std::uint8_t>(*sample));
  }
  if (beam.intensities.size() != kIctineuBins) {
    return tl::unexpected(fmt::format("has {} samples, not {}", beam.intensities.size(), kIctineuBins));
  }
  if (const Result<void> valid = validate(beam); !valid) return tl::unexpected(valid.error().message);
  return beam;
}

class IctineuBeams final : public BeamSource {
 public:
  IctineuBeams(StreamReader reader, Damage damage) : reader_(std::move(reader)), damage_(damage) {}

  Result<std::optional<Beam>> next() override {
    for (;;) {
      const std::uint64_t at = reader_.position();
      const Result<std::optional<std::string_view>> line = reader_.next_line();
      if (!line) return tl::unexpected(line.error());
      if (!*line) return std::nullopt;
      if (is_comment_or_blank(**line)) continue;
      tl::expected<Beam, std::string> beam = ictineu_beam_in(**line);
      if (beam) return *std::move(beam);
      const std::string_view kind = reader_.line_has_end() ? "damaged line" : FrameFinder::kCutOff;
      const auto counted = handle_damage(damage_, kinds_, kind, reader_.name(), at, beam.error());
      if (!counted) return tl::unexpected(counted.error());
    }
  }
  std::vector<DamageKind> damage() const override { return kinds_; }
  const DeviceProfile* device() const override { return find_device("miniking"); }
  std::optional<double> share_read() const override { return reader_.share_read(); }

 private:
  StreamReader reader_;
  Damage damage_;
  std::vector<DamageKind> kinds_;
};

}  // namespace

bool looks_like_ictineu_beams(std::span<const std::uint8_t> beginning) {
  Lines lines(text_of(beginning));
  while (const auto line = lines.next()) {
    if (!is_comment_or_blank(*line)) return lines.has_end() && ictineu_beam_in(*line).has_value();
  }
  return false;
}

Result<std::unique_ptr<BeamSource>> open_ictineu_beams(ByteStream stream, Damage damage) {
  return std::make_unique<IctineuBeams>(StreamReader(std::move(stream)), damage);
}

}  // namespace pingvox
