#include "sonar/internal/blanking.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/filters.hpp"
#include "support/tank_recording.hpp"

namespace pingvox {
namespace {

constexpr double kFineBin_m = 0.05;

/// A turn of a head that rings over its first `ringing` bins, with a wall somewhere behind it in each beam.
Sweep ringing_turn(std::mt19937_64& random, std::size_t ringing, int loudness, std::size_t beams = 60) {
  Sweep sweep{.extent = Sweep::Extent::kTurn, .beams = std::vector<Beam>(beams)};
  for (Beam& beam : sweep.beams) {
    beam.bin_length_m = kFineBin_m;
    beam.intensities.resize(200);
    const std::size_t wall = 40 + random() % 150;
    for (std::size_t i = 0; i < 200; ++i) {
      const int heard = (i < ringing ? loudness : 0) + (i >= wall && i < wall + 6 ? 150 : 0);
      beam.intensities[i] = static_cast<std::uint8_t>(heard + static_cast<int>(random() % 12));
    }
  }
  return sweep;
}

TEST(BlankingRange, IsFoundAtTheEndOfWhatIsInEveryBeam) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const std::size_t ringing = 3 + random() % 30;
    const Sweep sweep = ringing_turn(random, ringing, static_cast<int>(40 + random() % 100));
    const double found_m = blanking_range_m(PolarImage(sweep), sweep);
    const double end_m = static_cast<double>(ringing) * kFineBin_m;
    EXPECT_GE(found_m, end_m - 1e-9);
    EXPECT_LE(found_m, end_m + 0.25) << "a few bins of noise may go on falling";
  }
}

// Kills bins so short that more of them than integers count are in five centimetres.
TEST(BlankingRange, IsFoundInBinsOfAnyLength) {
  for (const double bin_length_m : {1e-300, 1e-30, 1e-9, 1e-3, 10.0}) {
    SCOPED_TRACE(bin_length_m);
    std::mt19937_64 random(3);
    Sweep sweep = ringing_turn(random, 20, 80);
    for (Beam& beam : sweep.beams) beam.bin_length_m = bin_length_m;
    const double bins = blanking_range_m(PolarImage(sweep), sweep) / bin_length_m;
    EXPECT_GE(bins, 20.0 - 1e-9);
    EXPECT_LE(bins, 100.0 + 1e-9);
  }
}

// Kills ringing that is taken for none because it is not loud.
TEST(BlankingRange, IsFoundOfFaintRinging) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const Sweep sweep = ringing_turn(random, 20, 14);
    const double found_m = blanking_range_m(PolarImage(sweep), sweep);
    EXPECT_GE(found_m, 1.0 - 1e-9);
    EXPECT_LE(found_m, 1.25);
  }
}

// Kills a range that ends where ringing begins to fade.
TEST(BlankingRange, EndsWhereTheRingingHasFaded) {
  std::mt19937_64 random(7);
  Sweep sweep{.extent = Sweep::Extent::kTurn, .beams = std::vector<Beam>(60)};
  for (Beam& beam : sweep.beams) {
    beam.bin_length_m = kFineBin_m;
    for (std::size_t i = 0; i < 200; ++i) {
      const double ringing = 100.0 * std::exp(-std::max(0.0, static_cast<double>(i) - 20.0) / 6.0);
      beam.intensities.push_back(static_cast<std::uint8_t>(ringing + static_cast<double>(random() % 4)));
    }
  }
  // 28 bins on it is a quarter of what it was, 35 bins on a twelfth.
  const double found_m = blanking_range_m(PolarImage(sweep), sweep);
  EXPECT_GE(found_m, 35.0 * kFineBin_m);
  EXPECT_LE(found_m, 50.0 * kFineBin_m);
}

// Kills a wall next to the head, which most beams hear but not all, that is taken for ringing.
TEST(BlankingRange, DoesNotEndBehindAWallThatFourOfFiveBeamsHear) {
  std::mt19937_64 random(13);
  Sweep sweep = ringing_turn(random, 10, 100);
  for (std::size_t n = 0; n < sweep.beams.size(); ++n) {
    if (n % 5 == 0) continue;
    for (std::size_t i = 10; i < 30; ++i) sweep.beams[n].intensities[i] = 100;
  }
  EXPECT_LT(blanking_range_m(PolarImage(sweep), sweep), 20.0 * kFineBin_m);
}

// Kills a range that ends where ringing has fallen to less than half, though it goes on at that.
TEST(BlankingRange, GoesOnOverRingingOfTwoParts) {
  std::mt19937_64 random(17);
  Sweep sweep = ringing_turn(random, 10, 200);
  for (Beam& beam : sweep.beams) {
    for (std::size_t i = 10; i < 30; ++i) beam.intensities[i] = static_cast<std::uint8_t>(80 + random() % 4);
  }
  EXPECT_GE(blanking_range_m(PolarImage(sweep), sweep), 30.0 * kFineBin_m - 1e-9);
}

TEST(BlankingRange, IsNoneWithoutRingingAndUsualInAFewBeams) {
  std::mt19937_64 random(5);
  const Sweep silent = ringing_turn(random, 0, 0);
  EXPECT_EQ(blanking_range_m(PolarImage(silent), silent), 0.0);
  const Sweep few = ringing_turn(random, 20, 100, 31);
  EXPECT_EQ(blanking_range_m(PolarImage(few), few), EchoOptions::kDefaultBlanking_m);
  const Sweep none;
  EXPECT_EQ(blanking_range_m(PolarImage(none), none), EchoOptions::kDefaultBlanking_m);
}

TEST(BlankingRange, IsAtMostHalfOfTheRange) {
  Sweep sweep{.extent = Sweep::Extent::kTurn, .beams = std::vector<Beam>(40)};
  for (Beam& beam : sweep.beams) {
    beam.bin_length_m = kFineBin_m;
    beam.intensities.assign(100, 200);
    for (std::size_t i = 60; i < 100; ++i) beam.intensities[i] = 0;
  }
  EXPECT_LE(blanking_range_m(PolarImage(sweep), sweep), 2.5);
}

TEST(BlankingRange, EndsBetweenRingingAndWallsInTheTankRecording) {
  std::vector<Beam> beams = test::TankRecording::beams(PINGVOX_SHARED_DATA);
  if (beams.empty()) GTEST_SKIP() << "no tank recording in " << PINGVOX_SHARED_DATA;
  for (std::size_t turn = 0; turn < 28; ++turn) {
    SCOPED_TRACE(turn);
    const auto first = beams.begin() + static_cast<std::ptrdiff_t>(200 * turn);
    const Sweep sweep{.extent = Sweep::Extent::kTurn, .beams = {first, first + 200}};
    const double found_m = blanking_range_m(apply_filter(PolarImage(sweep), {}), sweep);
    EXPECT_GT(found_m, 0.3);
    EXPECT_LT(found_m, 1.2);
  }
}

}  // namespace
}  // namespace pingvox
