#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "io/beams/device_log.hpp"
#include "io/beams/seanet_bearing.hpp"
#include "io/beams/stream_reader.hpp"
#include "io/bytes/date.hpp"
#include "io/bytes/text.hpp"
#include "io/internal/frame_finder.hpp"
#include "io/readers.hpp"

// Text of Tritech's SeanetDumpLog: a line for each ping (docs/formats.md).
namespace pingvox {
namespace {

/// Columns of a line of an imaging sonar.
enum DumplogColumn : std::size_t {
  kKind,
  kTimeOfDay,
  kNode,
  kStatus,
  kControl,
  kRangeScale,
  kBearing = 13,
  kSamples,
  kFirstSample
};

struct NodeBeam {
  unsigned node = 0;  ///< number of the head
  Beam beam;
};

tl::expected<NodeBeam, std::string> dumplog_beam_in(std::string_view line) {
  std::array<std::string_view, kFirstSample> fields;
  for (std::string_view& field : fields) {
    const auto cut = cut_field(line, ',');
    if (!cut) return tl::unexpected(std::string("has too few columns"));
    field = *cut;
  }
  const std::optional<double> time_s = time_of_day_s(fields[kTimeOfDay]);
  if (!time_s) return tl::unexpected(fmt::format("\"{}\" is not a time of day", printable(fields[kTimeOfDay])));
  const auto bearing = count_in(fields[kBearing]), range_scale = count_in(fields[kRangeScale]);
  const auto samples = count_in(fields[kSamples]);
  const std::optional<double> bearing_rad = bearing ? seanet_bearing_rad(*bearing) : std::nullopt;
  if (!bearing_rad) {
    return tl::unexpected(fmt::format("\"{}\" is not a bearing in 0..6400", printable(fields[kBearing])));
  }
  const auto node = count_in(fields[kNode]);
  if (const auto status = count_in(fields[kStatus])) {
    if (const auto fault = seanet_fault(*status)) return tl::unexpected(std::string(*fault));
  }
  if (!node || *node > 255) return tl::unexpected(fmt::format("\"{}\" is not a node", printable(fields[kNode])));
  if (!range_scale || *range_scale > 0xffff) {
    return tl::unexpected(fmt::format("\"{}\" is not a range scale", printable(fields[kRangeScale])));
  }

  Beam beam;
  beam.time_s = *time_s;
  beam.bearing_rad = *bearing_rad;
  while (const auto field = cut_field(line, ',')) {
    // Lines may end with a comma.
    if (field->empty() && line.data() == nullptr) break;
    const std::optional<std::uint64_t> sample = count_in(*field);
    if (!sample || *sample > 255) return tl::unexpected(fmt::format("\"{}\" is not a sample", printable(*field)));
    beam.intensities.push_back(static_cast<std::uint8_t>(*sample));
  }
  if (samples != beam.intensities.size()) {
    return tl::unexpected(fmt::format("has {} samples, not {}", beam.intensities.size(), printable(fields[kSamples])));
  }
  // Samples of 4 bits.
  const auto control = count_in(fields[kControl]);
  const bool is_coarse = control && (*control & 1) == 0;
  if (is_coarse && std::ranges::all_of(beam.intensities, [](std::uint8_t sample) { return sample < 16; })) {
    for (std::uint8_t& sample : beam.intensities) sample = static_cast<std::uint8_t>(17 * sample);
  }
  beam.bin_length_m = seanet_bin_length_m(static_cast<std::uint16_t>(*range_scale), beam.intensities.size());
  if (const Result<void> valid = validate(beam); !valid) return tl::unexpected(valid.error().message);
  return NodeBeam{static_cast<unsigned>(*node), std::move(beam)};
}

class DumpLog : public BeamSource {
 public:
  DumpLog(StreamReader reader, Damage damage) : reader_(std::move(reader)), damage_(damage) {}

  Result<std::optional<Beam>> next() override {
    for (;;) {
      const std::uint64_t at = reader_.position();
      const Result<std::optional<std::string_view>> line = reader_.next_line();
      if (!line) return tl::unexpected(line.error());
      if (!*line) return std::nullopt;
      // Lines of other devices.
      if (!(*line)->starts_with("SON,")) continue;
      tl::expected<NodeBeam, std::string> read = dumplog_beam_in(**line);
      if (read && first_head_.is(read->node)) {
        set_time(read->beam);
        return std::move(read->beam);
      }
      const std::string_view kind = read ? kOtherHead : reader_.line_has_end() ? "damaged line" : FrameFinder::kCutOff;
      const std::string_view reason = read ? kOtherHead : std::string_view(read.error());
      const auto counted = handle_damage(damage_, kinds_, kind, reader_.name(), at, reason);
      if (!counted) return tl::unexpected(counted.error());
    }
  }
  std::vector<DamageKind> damage() const override { return kinds_; }
  const DeviceProfile* device() const override { return find_device("micron"); }
  std::optional<double> share_read() const override { return reader_.share_read(); }
  BeamClock clock() const override { return BeamClock::kTimeOfDay; }

 private:
  /// Unwraps times of day at midnight.
  void set_time(Beam& beam) {
    constexpr double kDay_s = 86400.0;
    if (beam.time_s + days_s_ < last_s_ - kDay_s / 2) days_s_ += kDay_s;
    last_s_ = beam.time_s += days_s_;
  }

  StreamReader reader_;
  Damage damage_;
  FirstHead first_head_;
  double days_s_ = 0.0, last_s_ = 0.0;
  std::vector<DamageKind> kinds_;
};

}  // namespace

bool looks_like_dumplog(std::span<const std::uint8_t> beginning) {
  const std::string_view text = text_of(beginning);
  if (text.starts_with("SON,")) return true;
  Lines lines(text);
  const auto header = lines.next();
  if (header && header->starts_with("SOf") && header->find("Bearing") != std::string_view::npos) return true;
  // If the log begins within a line, the next one is whole.
  const auto second = lines.next();
  return second && second->starts_with("SON,") && dumplog_beam_in(*second);
}

Result<std::unique_ptr<BeamSource>> open_dumplog(ByteStream stream, Damage damage) {
  return std::make_unique<DumpLog>(StreamReader(std::move(stream)), damage);
}

}  // namespace pingvox
