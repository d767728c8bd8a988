#include "pingvox/sonar/background.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <span>

#include "pingvox/geometry/degree.hpp"
#include "sonar/internal/blanking.hpp"
#include "support/tank_recording.hpp"

namespace pingvox {
namespace {

constexpr double kBin_m = 0.0125;

/// Sweeps of a sonar on a vehicle whose frame answers with 120 at 0.8 m between 10 and 30 degrees, and that goes
/// along: in each sweep the wall is elsewhere.
std::vector<Beam> beams_of_a_vehicle(std::size_t sweeps, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  std::vector<Beam> beams;
  for (std::size_t sweep = 0; sweep < sweeps; ++sweep) {
    const std::size_t wall = 50 + 40 * sweep;
    for (int n = 0; n < 200; ++n) {
      const double bearing_deg = 1.8 * n;
      Beam beam{.time_s = static_cast<double>(beams.size()),
                .bearing_rad = bearing_deg * std::numbers::pi / 180.0,
                .bin_length_m = kBin_m,
                .intensities = std::vector<std::uint8_t>(600)};
      for (std::uint8_t& bin : beam.intensities) bin = static_cast<std::uint8_t>(random() % 6);
      if (bearing_deg > 10.0 && bearing_deg < 30.0) std::fill_n(beam.intensities.begin() + 64, 6, 120);
      std::fill_n(beam.intensities.begin() + static_cast<std::ptrdiff_t>(wall), 8, 200);
      beams.push_back(std::move(beam));
    }
  }
  return beams;
}

/// The same beams with bins this many times as short.
std::vector<Beam> with_short_bins(std::vector<Beam> beams, std::size_t times) {
  for (Beam& beam : beams) {
    std::vector<std::uint8_t> fine;
    for (const std::uint8_t bin : beam.intensities) fine.insert(fine.end(), times, bin);
    beam.bin_length_m /= static_cast<double>(times);
    beam.intensities = std::move(fine);
  }
  return beams;
}

Background learned(std::vector<Beam> beams, double range_m) {
  BeamsInMemory source(std::move(beams));
  Result<Background> background = Background::learn(source, {.range_m = range_m});
  EXPECT_TRUE(background);
  return *std::move(background);
}

TEST(Background, IsTheVehicleAndNotTheWallsThatItPasses) {
  const std::vector<Beam> beams = beams_of_a_vehicle(12);
  const Background background = learned(beams, 2.0);
  for (Beam beam : beams) {
    const Beam before = beam;
    background.subtract_from(beam);
    const double bearing_deg = beam.bearing_rad * 180.0 / std::numbers::pi;
    const auto loudest = *std::max_element(beam.intensities.begin() + 64, beam.intensities.begin() + 70);
    if (bearing_deg > 12.0 && bearing_deg < 28.0 && beam.time_s > 400.0) {
      EXPECT_LE(loudest, 8) << bearing_deg;
    }
    EXPECT_EQ(std::vector(beam.intensities.begin() + 160, beam.intensities.end()),
              std::vector(before.intensities.begin() + 160, before.intensities.end()))
        << "bins beyond the range";
    for (std::size_t bin = 0; bin < 600; ++bin) {
      EXPECT_LE(beam.intensities[bin], before.intensities[bin]);
      if (before.intensities[bin] == 200) {
        EXPECT_GE(beam.intensities[bin], 80) << "a wall is still an echo";
      }
    }
  }
}

// Kills a background of a direction that one sweep has seen once: its echoes would vanish.
// Bins shorter than a cell are not beams.
TEST(Background, NeedsSeveralBeamsOfADirection) {
  const std::vector<Beam> beams = with_short_bins(beams_of_a_vehicle(2), 5);
  const Background background = learned(beams, 5.0);
  for (Beam beam : beams) {
    const Beam before = beam;
    background.subtract_from(beam);
    EXPECT_EQ(beam.intensities, before.intensities);
  }
}

TEST(Background, DoesNotDependOnTheLengthOfBins) {
  const Background background = learned(beams_of_a_vehicle(12), 2.0);
  // Bins of 2.5 and of 1.25 mm, 8 and 16 of which fill a cell.
  const std::vector<Beam> eight = learned(with_short_bins(beams_of_a_vehicle(12), 5), 2.0).beams();
  const std::vector<Beam> sixteen = learned(with_short_bins(beams_of_a_vehicle(12), 10), 2.0).beams();
  ASSERT_EQ(eight.size(), sixteen.size());
  for (std::size_t n = 0; n < eight.size(); ++n) EXPECT_EQ(eight[n].intensities, sixteen[n].intensities) << n;
  Beam fine{.bearing_rad = 20.0 * kDegree_rad, .bin_length_m = 0.00125, .intensities = {}};
  fine.intensities.assign(2000, 120);
  background.subtract_from(fine);
  EXPECT_LE(fine.intensities[static_cast<std::size_t>(0.84 / 0.00125)], 8);
  EXPECT_GE(fine.intensities[static_cast<std::size_t>(0.70 / 0.00125)], 110);
}

/// Five turns of a head that rings, in water whose reverberation falls with the range and differs by direction, on a
/// vehicle that answers between 10 and 30 degrees.
std::vector<Beam> beams_in_reverberation() {
  std::vector<Beam> beams;
  for (int n = 0; n < 5 * 200; ++n) {
    const double bearing_deg = std::fmod(1.8 * n, 360.0);
    Beam beam{.time_s = 0.1 * n,
              .bearing_rad = bearing_deg * kDegree_rad,
              .bin_length_m = kBin_m,
              .intensities = std::vector<std::uint8_t>(400)};
    for (std::size_t bin = 0; bin < 400; ++bin) {
      const double range_m = (static_cast<double>(bin) + 0.5) * kBin_m;
      const double reverberation = (120.0 + 50.0 * std::sin(bearing_deg * kDegree_rad)) * std::exp(-0.5 * range_m);
      const bool is_vehicle = bearing_deg > 10.0 && bearing_deg < 30.0 && range_m > 0.8 && range_m < 0.9;
      beam.intensities[bin] = range_m < 0.4 ? 250 : is_vehicle ? 220 : static_cast<std::uint8_t>(reverberation);
    }
    beams.push_back(std::move(beam));
  }
  return beams;
}

// Kills a step at the end of the range: an echo in each beam, in front of the true ones.
TEST(Background, EndsWithoutARise) {
  const Background background = learned(beams_in_reverberation(), 1.5);
  for (Beam beam : beams_in_reverberation()) {
    background.subtract_from(beam);
    const std::span<const std::uint8_t> bins(beam.intensities);
    const auto lowest = *std::ranges::min_element(bins.subspan(40, 80));
    const auto loudest_behind = *std::ranges::max_element(bins.subspan(120));
    EXPECT_LE(loudest_behind, lowest + 8) << beam.bearing_rad / kDegree_rad;
  }
}

// Kills ringing that is subtracted: what is left of it is no longer known as ringing, and mapped.
TEST(Background, LeavesTheRingingToTheBlankingRange) {
  const Background background = learned(beams_in_reverberation(), 1.5);
  std::vector<Beam> turn = beams_in_reverberation();
  turn.resize(200);
  const Sweep before{.extent = Sweep::Extent::kTurn, .beams = turn};
  for (Beam& beam : turn) background.subtract_from(beam);
  const Sweep after{.extent = Sweep::Extent::kTurn, .beams = turn};
  EXPECT_GE(blanking_range_m(PolarImage(before), before), 0.4);
  EXPECT_GE(blanking_range_m(PolarImage(after), after), 0.4);
  EXPECT_LE(after.beams[10].intensities[68], 130) << "the vehicle, at 18 degrees";
}

// Kills silent beams in directions, and beyond ranges, that were never heard: black stripes in pictures.
TEST(Background, IsShownAsASweepOfWhatWasHeard) {
  const Background background = learned(beams_of_a_vehicle(12), 10.0);
  const std::vector<Beam> beams = background.beams();
  ASSERT_EQ(beams.size(), 200U) << "steps of 1.8 degrees";
  for (const Beam& beam : beams) {
    EXPECT_TRUE(validate(beam));
    EXPECT_EQ(beam.intensities.size(), 375U) << "7.5 m";
    const double bearing_deg = beam.bearing_rad / kDegree_rad;
    const auto loudest = *std::ranges::max_element(std::span(beam.intensities).first(75));
    if (bearing_deg > 11.0 && bearing_deg < 29.0) {
      EXPECT_GE(loudest, 116) << bearing_deg;
    } else if (bearing_deg < 9.0 || bearing_deg > 31.0) {
      EXPECT_LE(loudest, 8) << bearing_deg;
    }
  }
  EXPECT_TRUE(learned(beams_of_a_vehicle(Background::kMinBeams - 1), 10.0).beams().empty());
}

// Kills black rings where bins are longer than the cells of the background.
TEST(Background, LongBinsAreShownWithoutGaps) {
  std::vector<Beam> beams(5, Beam{.bin_length_m = 0.06, .intensities = {40, 80, 120, 160, 0, 0}});
  for (std::size_t i = 0; i < beams.size(); ++i) beams[i].time_s = static_cast<double>(i);
  const std::vector<Beam> shown = learned(beams, 1.0).beams();
  ASSERT_EQ(shown.size(), 1U);
  EXPECT_THAT(shown[0].intensities,
              testing::ElementsAre(40, 40, 40, 80, 80, 80, 120, 120, 120, 160, 160, 160, 0, 0, 0, 0, 0));
}

TEST(Background, RefusesARangeThatIsNone) {
  for (const double range_m : {0.0, -1.0, 10.1, std::nan("")}) {
    BeamsInMemory source({});
    EXPECT_FALSE(Background::learn(source, {.range_m = range_m})) << range_m;
  }
}

// In the recording some beams hear the vehicle out to 0.9 m.
TEST(Background, TakesTheVehicleOutOfTheTankRecording) {
  const std::vector<Beam> beams = test::TankRecording::beams(PINGVOX_SHARED_DATA);
  if (beams.empty()) GTEST_SKIP() << "no recording of the tank";
  const Background background = learned(beams, 1.2);
  std::size_t before = 0, after = 0;
  const auto near_m = [](const Beam& beam) {
    for (std::size_t bin = 36; bin < 75 && bin < beam.intensities.size(); ++bin) {
      if (beam.intensities[bin] > 70) return true;
    }
    return false;
  };
  for (Beam beam : beams) {
    before += near_m(beam) ? 1U : 0U;
    background.subtract_from(beam);
    after += near_m(beam) ? 1U : 0U;
  }
  EXPECT_GT(before, 500U);
  EXPECT_LT(after, before / 10);
}

}  // namespace
}  // namespace pingvox
