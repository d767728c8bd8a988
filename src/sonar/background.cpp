#include "pingvox/sonar/background.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>

#include "pingvox/sonar/beam_source_decorator.hpp"

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

std::size_t beams_in(const Histogram& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::size_t{0});
}

std::uint8_t median_of(const Histogram& counts) {
  const std::size_t total = beams_in(counts);
  if (total < Background::kMinBeams) return 0;
  std::size_t below = 0, step = 0;
  while (2 * (below + counts[step]) < total) below += counts[step++];
  return static_cast<std::uint8_t>(step * kStep);
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
  if (range_m > 0.0 && range_m <= kMaxRange_m) return {};
  return fail(Error::Code::kBadOption,
              fmt::format("background: range_m must be in (0, {}], is {}", kMaxRange_m, range_m));
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
  std::vector<std::uint8_t> medians(histograms.size());
  std::ranges::transform(histograms, medians.begin(), median_of);
  std::vector<bool> heard(histograms.size());
  for (std::size_t i = 0; i < heard.size(); ++i) heard[i] = beams_in(histograms[i]) >= kMinBeams;
  return Background(cells, std::move(medians), std::move(heard));
}

void Background::subtract_from(Beam& beam) const {
  const std::uint8_t* const row = intensities_.data() + direction_of(beam.bearing_rad, kDirections) * cells_;
  for (std::size_t bin = 0; bin < beam.intensities.size(); ++bin) {
    const std::size_t cell = cell_of(beam, bin);
    if (cell >= cells_) return;
    beam.intensities[bin] -= std::min(beam.intensities[bin], row[cell]);
  }
}

std::vector<Beam> Background::beams() const {
  std::vector<Beam> beams;
  for (std::size_t n = 0; n < kDirections; ++n) {
    std::vector<std::uint8_t> intensities;
    for (std::size_t cell = 0, next = 0; cell < cells_; ++cell) {
      // A bin longer than a cell was heard in the cell of its middle, and lies around it.
      if (!heard_[n * cells_ + cell]) continue;
      if (next > 0) intensities.resize(next + (cell - next) / 2, intensities.back());
      intensities.resize(cell + 1, intensities_[n * cells_ + cell]);
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
