#include "pingvox/sim/tank.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/filters.hpp"
#include "pingvox/sonar/sweep.hpp"

namespace pingvox {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;

std::vector<Beam> beams_of(const TankOptions& options) {
  EXPECT_TRUE(options.validate());
  TankSimulator simulator(options);
  std::vector<Beam> beams;
  for (;;) {
    auto beam = simulator.next();
    if (!beam || !*beam) return beams;
    beams.push_back(std::move(**beam));
  }
}

/// FNV-1a.
std::uint64_t checksum(const std::vector<Beam>& beams) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const Beam& beam : beams) {
    for (const std::uint8_t byte : beam.intensities) hash = (hash ^ byte) * 0x100000001b3U;
  }
  return hash;
}

TEST(TrueRange, IsTheWallsDistanceOverTheCosine) {
  TankOptions tank{.side_m = 4.0, .sensor_x_m = 0.5, .sensor_y_m = -0.25, .sensor_yaw_rad = 0.0};
  tank.floater_radius_m = 0.0;
  EXPECT_NEAR(true_range_m(tank, 0.0), 1.5, 1e-12);
  EXPECT_NEAR(true_range_m(tank, kPi / 2), 2.25, 1e-12) << "left";
  EXPECT_NEAR(true_range_m(tank, kPi), 2.5, 1e-12);
  EXPECT_NEAR(true_range_m(tank, -kPi / 2), 1.75, 1e-12) << "right";
  EXPECT_NEAR(true_range_m(tank, kPi / 6), 1.5 / std::cos(kPi / 6), 1e-12);
  EXPECT_NEAR(true_range_m(tank, std::atan2(2.25, 1.5)), std::hypot(2.25, 1.5), 1e-9) << "the corner";
  tank.sensor_yaw_rad = 0.2;
  EXPECT_NEAR(true_range_m(tank, -0.2), 1.5, 1e-12) << "a sensor turned to the left sees the front wall to its right";
}

TEST(TrueRange, IsTheFloatersNearSideWhereItStandsInTheWay) {
  TankOptions tank{.side_m = 4.0, .sensor_x_m = 0.0, .sensor_y_m = 0.0, .sensor_yaw_rad = 0.1};
  tank.floater_bearing_rad = 1.0;
  tank.floater_range_m = 1.2;
  tank.floater_radius_m = 0.3;
  EXPECT_NEAR(true_range_m(tank, 1.0), 0.9, 1e-12);
  const double edge = std::asin(0.3 / 1.2);
  EXPECT_NEAR(true_range_m(tank, 1.0 + edge - 1e-9), std::sqrt(1.2 * 1.2 - 0.3 * 0.3), 1e-3) << "the tangent";
  EXPECT_GT(true_range_m(tank, 1.0 + edge + 1e-6), 1.9);
  EXPECT_GT(true_range_m(tank, 1.0 + kPi), 1.9) << "a floater behind is not in the way";
}

TEST(TankSimulator, SendsValidBeamsOfTheOrderedShape) {
  const TankOptions options{.turns = 2};
  const std::vector<Beam> beams = beams_of(options);
  ASSERT_EQ(beams.size(), 400U);
  for (std::size_t n = 0; n < beams.size(); ++n) {
    SCOPED_TRACE(n);
    ASSERT_TRUE(validate(beams[n]));
    EXPECT_EQ(beams[n].intensities.size(), 399U);
    EXPECT_DOUBLE_EQ(beams[n].time_s, static_cast<double>(n) / 23.0);
  }
  EXPECT_NEAR(beams[1].bearing_rad, 2 * kPi - 1.8 * kPi / 180, 1e-12) << "clockwise, as these heads turn";
  EXPECT_EQ(beams[0].bearing_rad, beams[200].bearing_rad);
  EXPECT_NE(beams[0].intensities, beams[200].intensities) << "noise repeats itself";
}

TEST(TankSimulator, MakesTheSameBytesFromTheSameSeedOnEveryMachine) {
  const std::vector<Beam> beams = beams_of({});
  EXPECT_EQ(beams.size(), 1000U);
  EXPECT_EQ(checksum(beams), 9321807636717623915U);
  EXPECT_EQ(checksum(beams), checksum(beams_of({})));
  EXPECT_NE(checksum(beams), checksum(beams_of({.seed = 2})));
}

TEST(TankSimulator, IsSilentWithoutNoiseBetweenTheHeadAndTheFirstWall) {
  TankOptions options{.turns = 1};
  options.noise = 0.0;
  options.floater_radius_m = 0.0;
  for (const Beam& beam : beams_of(options)) {
    SCOPED_TRACE(beam.bearing_rad);
    EXPECT_GT(beam.intensities[10], 50) << "self-reflection";
    for (std::size_t i = 40; i < 110; ++i) EXPECT_EQ(beam.intensities[i], 0) << i;
    const auto wall = static_cast<std::size_t>(true_range_m(options, beam.bearing_rad) / options.bin_length_m);
    EXPECT_GT(beam.intensities[wall], 40);
  }
}

TEST(TankSimulator, HearsTheWallAgainInItsMirrorImage) {
  TankOptions options{.turns = 1, .sensor_x_m = 0.0, .sensor_yaw_rad = 0.0, .bins = 800};
  options.noise = options.speckle = 0.0;
  options.floater_radius_m = 0.0;
  options.side_m = 2.0;
  options.sensor_y_m = 0.0;
  // Ahead, 1 m; from there back to the wall behind, 3 m; and ahead again, 5 m.
  const Beam beam = beams_of(options).front();
  const auto strongest_near = [&beam](std::size_t bin) {
    std::size_t best = bin - 30;
    for (std::size_t i = best; i < bin + 30; ++i) best = beam.intensities[i] > beam.intensities[best] ? i : best;
    return best;
  };
  EXPECT_NEAR(static_cast<double>(strongest_near(240)), 241.0, 4.0);
  EXPECT_NEAR(static_cast<double>(strongest_near(400)), 402.0, 6.0);
  options.second_echo = 0.0;
  const Beam single = beams_of(options).front();
  EXPECT_LT(single.intensities[240], beam.intensities[240] / 2);
}

TEST(TankSimulator, GivesTheDefaultDetectorTheTruth) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    SCOPED_TRACE(seed);
    const TankOptions options{.seed = seed};
    SweepAssembler assembler;
    std::size_t beams = 0;
    std::size_t good = 0;
    std::size_t wrong = 0;
    const auto judge = [&](const std::optional<Sweep>& sweep) {
      if (!sweep) return;
      EXPECT_EQ(sweep->extent, Sweep::Extent::kTurn);
      const auto echoes = detect_echoes(filtered(PolarImage(*sweep), {}), *sweep, {});
      for (std::size_t n = 0; n < echoes.size(); ++n) {
        ++beams;
        if (!echoes[n]) continue;
        const double error = std::abs(echoes[n]->range_m - true_range_m(options, sweep->beams[n].bearing_rad));
        good += error <= 0.05 ? 1U : 0U;
        wrong += error > 0.10 ? 1U : 0U;
      }
    };
    for (Beam& beam : beams_of(options)) judge(assembler.add(std::move(beam)));
    judge(assembler.finish());
    ASSERT_EQ(beams, 1000U);
    EXPECT_GE(good, 950U);
    EXPECT_LT(wrong, 20U);
  }
}

TEST(TankOptions, NameEveryBrokenField) {
  EXPECT_TRUE(TankOptions{}.validate());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  TankOptions broken{.turns = 0,
                     .side_m = nan,
                     .sensor_yaw_rad = nan,
                     .floater_range_m = 0.01,
                     .beams_per_turn = 3,
                     .bins = 0,
                     .bin_length_m = 0.0,
                     .beams_per_s = 0.0,
                     .beam_width_rad = 0.0,
                     .beam_height_rad = 3.0,
                     .ringing_m = -1.0,
                     .speckle = 1.1,
                     .noise = nan,
                     .second_echo = 1.0};
  EXPECT_THAT(broken.validate().error().message,
              AllOf(HasSubstr("turns"), HasSubstr("side_m"), HasSubstr("sensor_x_m"), HasSubstr("sensor_yaw_rad"),
                    HasSubstr("floater_range_m"), HasSubstr("beams_per_turn"), HasSubstr("bins"),
                    HasSubstr("bin_length_m"), HasSubstr("beams_per_s")));
  EXPECT_THAT(broken.validate().error().message,
              AllOf(HasSubstr("beam_width_rad"), HasSubstr("beam_height_rad"), HasSubstr("ringing_m"),
                    HasSubstr("speckle"), HasSubstr("noise"), HasSubstr("second_echo")));
}

TEST(TankSimulator, SurvivesTheExtremesOfItsOptions) {
  std::size_t ran = 0;
  for (const double bin_m : {1e-6, 1.0}) {
    for (const double side_m : {0.01, 1000.0}) {
      TankOptions options{.turns = 1, .side_m = side_m, .sensor_x_m = 0.0, .sensor_y_m = 0.0};
      options.floater_range_m = side_m;  // outside of the tank: never met
      options.floater_radius_m = 0.0;
      options.beams_per_turn = 4;
      options.bin_length_m = bin_m;
      options.beam_width_rad = 1.0;
      options.beam_height_rad = 2.0;
      options.speckle = 1.0;
      options.noise = 255.0;
      EXPECT_EQ(beams_of(options).size(), 4U);
      ++ran;
    }
  }
  EXPECT_EQ(ran, 4U);
}

}  // namespace
}  // namespace pingvox
