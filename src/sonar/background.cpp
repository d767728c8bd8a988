#include "pingvox/sonar/background.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "base/option_errors.hpp"
#include "sonar/internal/beam_source_decorator.hpp"
#include "sonar/internal/option_limits.hpp"

namespace pingvox {
namespace {

/// Number of beams by intensity, in steps that keep ten metres of range within 25 MB.
constexpr unsigned kStep = 4;
using Histogram = std::array<std::uint16_t, 256 / kStep>;

std::size_t direction_of(double bearing_rad, std::size_t directions) {
  const double share = bearing_rad / (2.0 * std::numbers::pi);
  return static_cast<std::size_t>(std::lround(share * static_cast<double>(directions))) % directions;
}

/// The cell of a bin's middle.
std::size_t cell_of(const Beam& beam, std::size_t bin) {
  return static_cast<std::size_t>((static_cast<double>(bin) + 0.5) * beam.bin_length_m / Background::kCell_m);
}

/// Median intensity of the beams of a cell; nullopt: too few.
std::optional<std::uint8_t> median_of(const Histogram& counts) {
  const std::size_t total = std::accumulate(counts.begin(), counts.end(), std::size_t{0});
  if (total < Background::kMinBeams) return std::nullopt;
  std::size_t below = 0, step = 0;
  while (2 * (below + counts[step]) < total) below += counts[step++];
  return static_cast<std::uint8_t>(step * kStep);
}

using Medians = std::vector<std::optional<std::uint8_t>>;

/// What nine of ten directions hear at least at a range: ringing and reverberation. 0 where few directions were heard,
/// as all of them might point at the same thing.
/// @param medians  of all directions, `cells` of each
std::uint8_t common_level(const Medians& medians, std::size_t cells, std::size_t cell) {
  constexpr std::size_t kMinDirections = 32;
  std::vector<std::uint8_t> heard;
  for (std::size_t i = cell; i < medians.size(); i += cells) {
    if (medians[i]) heard.push_back(*medians[i]);
  }
  if (heard.size() < kMinDirections) return 0;
  const auto low = heard.begin() + static_cast<std::ptrdiff_t>(heard.size() / 10);
  std::ranges::nth_element(heard, low);
  return *low;
}

/// The intensity at the far end of what was heard of a direction.
std::uint8_t level_at_end(std::span<const std::optional<std::uint8_t>> direction) {
  constexpr std::size_t kCells = 5;
  std::uint8_t level = 0;
  std::size_t end = direction.size();
  while (end > 0 && !direction[end - 1]) --end;
  for (std::size_t cell = end - std::min(end, kCells); cell < end; ++cell) {
    level = std::max(level, direction[cell].value_or(0));
  }
  return level;
}

class BackgroundSubtractor final : public BeamSourceDecorator {
 public:
  BackgroundSubtractor(std::unique_ptr<BeamSource> source, Background background)
      : BeamSourceDecorator(std::move(source)), background_(std::move(background)) {}

  Result<std::optional<Beam>> next() override {
    Result<std::optional<Beam>> beam = source().next();
    if (beam && *beam) background_.subtract_from(**beam);
    return beam;
  }

 private:
  Background background_;
};

}  // namespace

Result<void> BackgroundOptions::validate() const {
  OptionErrors errors;
  errors.require("range_m", range_m, kBackgroundRanges_m);
  return errors.result("background");
}

Result<Background> Background::learn(BeamSource& source, const BackgroundOptions& options) {
  if (const auto valid = options.validate(); !valid) return tl::unexpected(valid.error());
  const auto cells = static_cast<std::size_t>(std::ceil(options.range_m / kCell_m - 1e-9));
  std::vector<Histogram> histograms(kDirections * cells, Histogram{});
  for (;;) {
    const Result<std::optional<Beam>> beam = source.next();
    if (!beam) return tl::unexpected(beam.error());
    if (!*beam) break;
    Histogram* const row = histograms.data() + direction_of((*beam)->bearing_rad, kDirections) * cells;
    const std::vector<std::uint8_t>& intensities = (*beam)->intensities;
    // The loudest bin of a cell: a beam counts once, however short its bins are.
    for (std::size_t bin = 0; bin < intensities.size();) {
      const std::size_t cell = cell_of(**beam, bin);
      if (cell >= cells) break;
      std::uint8_t loudest = 0;
      for (; bin < intensities.size() && cell_of(**beam, bin) == cell; ++bin) {
        loudest = std::max(loudest, intensities[bin]);
      }
      std::uint16_t& count = row[cell][loudest / kStep];
      count = static_cast<std::uint16_t>(std::min(count + 1, 0xffff));
    }
  }
  Medians medians(histograms.size());
  std::ranges::transform(histograms, medians.begin(), median_of);
  std::vector<std::uint8_t> common(cells);
  for (std::size_t cell = 0; cell < cells; ++cell) common[cell] = common_level(medians, cells, cell);
  for (auto direction = medians.begin(); direction != medians.end(); direction += static_cast<std::ptrdiff_t>(cells)) {
    // Without a step at the end, which would be the rise of an echo.
    const std::uint8_t end = level_at_end({direction, cells});
    for (std::size_t cell = 0; cell < cells; ++cell) {
      std::optional<std::uint8_t>& intensity = direction[static_cast<std::ptrdiff_t>(cell)];
      if (intensity) *intensity -= std::min(*intensity, std::max(end, common[cell]));
    }
  }
  return Background(cells, std::move(medians));
}

void Background::subtract_from(Beam& beam) const {
  const auto* const direction = intensities_.data() + direction_of(beam.bearing_rad, kDirections) * cells_;
  for (std::size_t bin = 0; bin < beam.intensities.size(); ++bin) {
    const std::size_t cell = cell_of(beam, bin);
    if (cell >= cells_) return;
    beam.intensities[bin] -= std::min(beam.intensities[bin], direction[cell].value_or(0));
  }
}

bool Background::empty() const {
  return std::ranges::none_of(intensities_, [](const auto& intensity) { return intensity.has_value(); });
}

std::vector<Beam> Background::beams() const {
  std::vector<Beam> beams;
  for (std::size_t n = 0; n < kDirections; ++n) {
    std::vector<std::uint8_t> intensities;
    for (std::size_t cell = 0, next = 0; cell < cells_; ++cell) {
      // A bin longer than a cell was heard in the cell of its middle, and lies around it.
      const std::optional<std::uint8_t>& intensity = intensities_[n * cells_ + cell];
      if (!intensity) continue;
      if (next > 0) intensities.resize(next + (cell - next) / 2, intensities.back());
      intensities.resize(cell + 1, *intensity);
      next = cell + 1;
    }
    if (intensities.empty()) continue;
    beams.push_back({.time_s = static_cast<double>(n),
                     .bearing_rad = static_cast<double>(n) * 2.0 * std::numbers::pi / kDirections,
                     .bin_length_m = kCell_m,
                     .intensities = std::move(intensities)});
  }
  return beams;
}

std::unique_ptr<BeamSource> subtract_background(std::unique_ptr<BeamSource> source, Background background) {
  return std::make_unique<BackgroundSubtractor>(std::move(source), std::move(background));
}

}  // namespace pingvox
