#include <fmt/core.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "io/bytes/text.hpp"
#include "io/readers.hpp"
#include "pingvox/io/byte_stream.hpp"
#include "pingvox/io/file.hpp"

// Thresholded beams of the Ictineu's MiniKing: the bins that were hit, as text, with the times of the beams in a file
// beside it (docs/formats.md).
namespace pingvox {
namespace {

constexpr std::string_view kHitsHeader = "# turn beam count bin";
constexpr std::string_view kTimesEnd = "_IS_timestamps.log";
constexpr std::size_t kBeamsPerTurn = 200, kHitBins = 500;
constexpr double kHitBinLength_m = 0.1;
/// Lines of the file of times that come before the first turn.
constexpr std::size_t kLinesBefore = 147;

struct HitBeam {
  std::size_t index = 0;  ///< among all beams in order of time
  std::vector<std::uint16_t> bins;
};

/// Parses a line; the error is the reason why it is invalid.
/// @param beams  how many have a time
tl::expected<HitBeam, std::string> hits_in(std::string_view line, std::size_t beams) {
  std::array<std::uint64_t, 3> numbers = {};
  for (std::uint64_t& number : numbers) {
    const auto word = cut_word(line);
    const auto count = word ? count_in(*word) : std::nullopt;
    if (!count) return tl::unexpected(std::string("does not begin with turn, beam and count"));
    number = *count;
  }
  const auto [turn, beam, count] = numbers;
  if (beam >= kBeamsPerTurn) return tl::unexpected(fmt::format("has beam {}, of 0..{}", beam, kBeamsPerTurn - 1));
  if (turn == 0 || turn > beams / kBeamsPerTurn) return tl::unexpected(fmt::format("has no times of turn {}", turn));
  // The head turns towards falling numbers.
  HitBeam hits{(turn - 1) * kBeamsPerTurn + (kBeamsPerTurn - 1 - beam), {}};
  while (const auto word = cut_word(line)) {
    const auto bin = count_in(*word);
    if (!bin || *bin == 0 || *bin > kHitBins) {
      return tl::unexpected(fmt::format("bin \"{}\" is not in 1..{}", printable(*word), kHitBins));
    }
    hits.bins.push_back(static_cast<std::uint16_t>(*bin - 1));
  }
  if (hits.bins.size() != count) {
    return tl::unexpected(fmt::format("has {} bins, but says {}", hits.bins.size(), count));
  }
  return hits;
}

/// A log without a name, as from standard input, has no times.
Result<FileBytes> read_times_beside(const std::string& name) {
  const std::vector<std::string> found =
      name == ByteStream::kStandardInput ? std::vector<std::string>() : times_beside_hits(name);
  if (found.size() != 1) {
    return fail(Error::Code::kUnsupported,
                fmt::format("{}: needs the times of its beams in one file *{} beside it", name, kTimesEnd));
  }
  return read_file(found.front());
}

Result<std::vector<double>> read_times(const FileBytes& file) {
  std::vector<double> times_s;
  Lines lines(text_of(file.view()));
  std::size_t number = 0;
  while (const auto line = lines.next_with_content()) {
    if (number++ < kLinesBefore) continue;
    std::string_view rest = *line;
    const auto time_s = number_in(cut_word(rest).value_or(""));
    // A line left out would shift the times of all later beams.
    if (!time_s) {
      return fail(Error::Code::kCorrupt,
                  fmt::format("{}: line {}: does not begin with a time", file.name, lines.number()));
    }
    times_s.push_back(*time_s);
  }
  return times_s;
}

class HitSource : public BeamSource {
 public:
  HitSource(std::map<std::size_t, std::vector<std::uint16_t>> hits, std::vector<double> times_s, SkippedRecords skipped)
      : hits_(std::move(hits)), times_s_(std::move(times_s)), skipped_(std::move(skipped)) {
    if (hits_.empty()) return;
    // Turns are complete: a beam that is not in the file has no hits.
    begin_ = next_ = hits_.begin()->first / kBeamsPerTurn * kBeamsPerTurn;
    end_ = (hits_.rbegin()->first / kBeamsPerTurn + 1) * kBeamsPerTurn;
  }

  Result<std::optional<Beam>> next() override {
    if (next_ >= end_) return std::nullopt;
    Beam beam;
    beam.time_s = times_s_[next_];
    const auto angle = static_cast<double>(kBeamsPerTurn - 1 - next_ % kBeamsPerTurn);
    beam.bearing_rad = wrap_bearing(-2.0 * std::numbers::pi * angle / kBeamsPerTurn);
    beam.bin_length_m = kHitBinLength_m;
    beam.intensities.assign(kHitBins, 0);
    if (const auto hits = hits_.find(next_); hits != hits_.end()) {
      for (const std::uint16_t bin : hits->second) beam.intensities[bin] = 255;
    }
    ++next_;
    return beam;
  }

  std::size_t skipped() const override { return skipped_.count; }
  std::string first_damage() const override { return skipped_.first; }
  const DeviceProfile* device() const override { return find_device("miniking"); }
  std::optional<double> share_read() const override { return read_share(end_ - next_, end_ - begin_); }

 private:
  std::map<std::size_t, std::vector<std::uint16_t>> hits_;  ///< bins of each beam with echoes
  std::vector<double> times_s_;
  SkippedRecords skipped_;
  std::size_t begin_ = 0, next_ = 0, end_ = 0;  ///< beams
};

}  // namespace

bool looks_like_beam_hits(std::span<const std::uint8_t> bytes) {
  return text_of(bytes).starts_with(kHitsHeader);
}

std::vector<std::string> times_beside_hits(const std::string& log) {
  std::vector<std::string> found;
  std::error_code error;
  const std::filesystem::path parent = std::filesystem::path(log).parent_path();
  std::filesystem::directory_iterator entries(parent.empty() ? "." : parent, error), end;
  for (; !error && entries != end; entries.increment(error)) {
    if (entries->path().filename().string().ends_with(kTimesEnd)) found.push_back(entries->path().string());
  }
  return found;
}

Result<std::unique_ptr<BeamSource>> open_beam_hits(const FileBytes& file, Damage damage) {
  Result<std::vector<double>> times_s = read_times_beside(file.name).and_then(read_times);
  if (!times_s) return tl::unexpected(times_s.error());
  std::map<std::size_t, std::vector<std::uint16_t>> hits;
  SkippedRecords skipped;
  Lines lines(text_of(file.view()));
  while (const auto line = lines.next_with_content()) {
    tl::expected<HitBeam, std::string> beam = hits_in(*line, times_s->size());
    if (beam) {
      // Of a duplicate beam, the first counts.
      hits.emplace(beam->index, std::move(beam->bins));
      continue;
    }
    const auto damaged =
        handle_damage(damage, skipped, file.name, fmt::format("line {}", lines.number()), beam.error());
    if (!damaged) return tl::unexpected(damaged.error());
  }
  return std::make_unique<HitSource>(std::move(hits), *std::move(times_s), std::move(skipped));
}

}  // namespace pingvox
