#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "pingvox/sonar/background.hpp"

namespace pingvox {
namespace {

constexpr double kCell_m = Background::kCell_m;
constexpr std::size_t kDirections = 360;

/// Intensities heard in each cell of each direction, one of a beam: the loudest.
using Heard = std::vector<std::vector<std::vector<std::uint8_t>>>;

std::size_t direction_of(const Beam& beam) {
  return static_cast<std::size_t>(std::lround(beam.bearing_rad * 180.0 / std::numbers::pi)) % kDirections;
}

std::size_t cell_of(const Beam& beam, std::size_t bin) {
  return static_cast<std::size_t>((static_cast<double>(bin) + 0.5) * beam.bin_length_m / kCell_m);
}

Heard heard_of(const std::vector<Beam>& beams, std::size_t cells) {
  Heard heard(kDirections, std::vector<std::vector<std::uint8_t>>(cells));
  for (const Beam& beam : beams) {
    std::vector<int> loudest(cells, -1);
    for (std::size_t bin = 0; bin < beam.intensities.size(); ++bin) {
      const std::size_t cell = cell_of(beam, bin);
      if (cell < cells) loudest[cell] = std::max<int>(loudest[cell], beam.intensities[bin]);
    }
    for (std::size_t cell = 0; cell < cells; ++cell) {
      if (loudest[cell] >= 0) heard[direction_of(beam)][cell].push_back(static_cast<std::uint8_t>(loudest[cell]));
    }
  }
  return heard;
}

/// By the words of the header, without histograms. Intensities are told in steps of four.
std::vector<std::vector<int>> plain_background(const Heard& heard, std::size_t cells) {
  std::vector<std::vector<int>> medians(kDirections, std::vector<int>(cells, -1));
  for (std::size_t n = 0; n < kDirections; ++n) {
    for (std::size_t cell = 0; cell < cells; ++cell) {
      std::vector<std::uint8_t> sorted = heard[n][cell];
      if (sorted.size() < Background::kMinBeams) continue;
      std::ranges::sort(sorted);
      medians[n][cell] = sorted[(sorted.size() - 1) / 2] / 4 * 4;
    }
  }
  std::vector<std::vector<int>> background(kDirections, std::vector<int>(cells, 0));
  for (std::size_t n = 0; n < kDirections; ++n) {
    std::vector<int> known;
    for (const int median : medians[n]) known.push_back(median);
    while (!known.empty() && known.back() < 0) known.pop_back();
    const auto last_five = known.end() - static_cast<std::ptrdiff_t>(std::min<std::size_t>(known.size(), 5));
    const int at_end = known.empty() ? 0 : std::max(0, *std::max_element(last_five, known.end()));
    for (std::size_t cell = 0; cell < cells; ++cell) {
      std::vector<int> of_all;
      for (const auto& median : medians) {
        if (median[cell] >= 0) of_all.push_back(median[cell]);
      }
      std::ranges::sort(of_all);
      const int common = of_all.size() < 32 ? 0 : of_all[of_all.size() / 10];
      background[n][cell] = std::max(0, medians[n][cell] - std::max(at_end, common));
    }
  }
  return background;
}

/// Beams of any bins and lengths into about as many directions as it takes to tell ringing, and on both sides of ahead.
std::vector<Beam> random_beams(std::mt19937_64& random) {
  const auto below = [&random](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  const std::size_t directions = 25 + below(15);
  std::vector<Beam> beams;
  for (std::size_t i = 0; i < 8 * directions; ++i) {
    const std::size_t direction = i % directions;
    const double off_deg = static_cast<double>(below(900)) / 1000.0 - 0.45;
    double bearing_deg = static_cast<double>(direction * 359 / (directions - 1)) + off_deg;
    if (bearing_deg < 0.0) bearing_deg += 360.0;
    Beam beam{.time_s = static_cast<double>(i),
              .bearing_rad = bearing_deg * std::numbers::pi / 180.0,
              .bin_length_m = std::array{0.007, 0.013, 0.02, 0.031}[below(4)],
              .intensities = std::vector<std::uint8_t>(5 + below(60))};
    for (std::size_t bin = 0; bin < beam.intensities.size(); ++bin) {
      const std::size_t level = (direction * 37 + cell_of(beam, bin) * 11) % 190;
      beam.intensities[bin] = static_cast<std::uint8_t>(level + below(60));
    }
    beams.push_back(std::move(beam));
  }
  return beams;
}

TEST(BackgroundByDefinition, IsWhatIsSubtracted) {
  std::size_t lowered = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937_64 random(seed);
    const std::size_t cells = 20 + random() % 20;
    const std::vector<Beam> beams = random_beams(random);
    const std::vector<std::vector<int>> plain = plain_background(heard_of(beams, cells), cells);
    BeamsInMemory source(beams);
    const Result<Background> background = Background::learn(source, {.range_m = static_cast<double>(cells) * kCell_m});
    ASSERT_TRUE(background);
    for (const Beam& beam : beams) {
      Beam left = beam;
      background->subtract_from(left);
      for (std::size_t bin = 0; bin < beam.intensities.size(); ++bin) {
        const std::size_t cell = cell_of(beam, bin);
        const int subtracted = cell < cells ? plain[direction_of(beam)][cell] : 0;
        ASSERT_EQ(left.intensities[bin], std::max(0, beam.intensities[bin] - subtracted))
            << "bearing " << beam.bearing_rad << ", cell " << cell << " of " << cells;
        lowered += left.intensities[bin] < beam.intensities[bin] ? 1U : 0U;
      }
    }
  }
  EXPECT_GT(lowered, 1000U);
}

}  // namespace
}  // namespace pingvox
