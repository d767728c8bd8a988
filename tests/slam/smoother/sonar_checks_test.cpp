#include "slam/smoother/sonar_checks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pingvox/slam/causal_replay.hpp"
#include "pingvox/slam/slam_smoother.hpp"
#include "tests/support/room.hpp"
#include "tests/support/turning_vehicle.hpp"

namespace pingvox {
namespace {

using test::Room;
using test::wander;
using test::Yaw;
using testing::HasSubstr;

/// Turns the same way once in 40 s, and not like a sine: that shifted by some seconds is nearly one with a smaller
/// amplitude.
double round_and_round(double time_s) {
  const double phase = 2.0 * std::numbers::pi * time_s / 40.0;
  return 0.4 * std::sin(phase) + 0.15 * std::sin(3.0 * phase + 1.0);
}

/// What the smoother, or CausalReplay, reports of a vehicle that turns on the spot in a room, ten beams a second.
template <class Slam = SlamSmoother>
SlamReport report_of(const Yaw& yaw, const SlamOptions& options, int beams = 1500) {
  Slam smoother(options);
  const bool is_upside_down = options.body_from_sonar.rotation()(2, 2) < 0.0;
  for (int i = 0; i < beams; ++i) {
    Beam beam = Room{}.beam(i, {0.4, -0.3, yaw(0.1 * i)});
    if (is_upside_down) beam.bearing_rad = wrap_bearing(-beam.bearing_rad);
    smoother.add(std::move(beam));
  }
  for (int i = -100; i < beams + 100; ++i) {
    NavSample sample;
    sample.time_s = 0.1 * i;
    EXPECT_TRUE(smoother.add("dvl", NavQuantity::kVelocity, sample));
    sample.value.x() = yaw(sample.time_s);
    EXPECT_TRUE(smoother.add("compass", NavQuantity::kHeading, sample));
  }
  const auto solved = smoother.solve();
  EXPECT_TRUE(solved) << solved.error().message;
  return solved ? solved->report : SlamReport();
}

SlamOptions late(double offset_s) {
  SlamOptions options;
  options.nav_offset_s = offset_s;
  return options;
}

bool names_the_clock(const SlamReport& report) {
  return testing::Value(report.implausible, testing::Contains(HasSubstr("clock of compass")));
}

// Kills a wrong clock that is not named, a right one that is, and an offset of the wrong sign.
TEST(SonarChecks, AClockThatTheTurningOfThePictureContradictsIsImplausible) {
  for (const double offset_s : {0.0, 4.0, -4.0}) {
    for (const SlamReport& report :
         {report_of(wander, late(offset_s)), report_of<CausalReplay>(wander, late(offset_s))}) {
      ASSERT_TRUE(report.clock_check) << offset_s;
      EXPECT_NEAR(report.clock_check->offset_s, -offset_s, 0.3);
      EXPECT_LT(report.clock_check->deviation_s, 0.5);
      EXPECT_EQ(names_the_clock(report), offset_s != 0.0) << offset_s;
    }
  }
}

// Kills a search that is given up because the next round looks like this one.
TEST(SonarChecks, RoundsThatAreAlikeTellTheClockNearZero) {
  constexpr int kBeams = 3000;  // more than seven rounds: one round later, too, nearly all of them agree
  const SlamReport report = report_of(round_and_round, late(5.0), kBeams);
  ASSERT_TRUE(report.clock_check);
  EXPECT_NEAR(report.clock_check->offset_s, -5.0, 0.5);
  EXPECT_TRUE(names_the_clock(report));
}

// Kills an offset that is a round less or more than the true one and said as if it were the only one.
TEST(SonarChecks, AnOffsetThatRoundsThatAreAlikeDoNotTellIsOneOfSeveral) {
  const SlamReport report = report_of(round_and_round, late(25.0), 3000);
  ASSERT_TRUE(report.clock_check);
  EXPECT_NEAR(report.clock_check->offset_s, 15.0, 0.5) << "-25, and a round of 40 s";
  EXPECT_TRUE(report.clock_check->is_one_of_several);
  EXPECT_THAT(report.implausible, testing::Contains(HasSubstr("s, or another, from")));
}

// Kills the border of what was tried that is taken for the best.
TEST(SonarChecks, AnOffsetJustBeyondTheFirstSearchIsFound) {
  const Yaw slower = [](double time_s) { return round_and_round(time_s * 40.0 / 90.0); };
  const SlamReport report = report_of(slower, late(25.0), 6000);
  ASSERT_TRUE(report.clock_check);
  EXPECT_NEAR(report.clock_check->offset_s, -25.0, 0.5);
  EXPECT_TRUE(names_the_clock(report));
}

TEST(SonarChecks, AHeadThatIsUpsideDownChecksTheClockAsWell) {
  SlamOptions options = late(4.0);
  options.body_from_sonar = pose_from_rpy(Eigen::Vector3d::Zero(), std::numbers::pi, 0.0, 0.4);
  const SlamReport report = report_of(wander, options);
  ASSERT_TRUE(report.clock_check);
  EXPECT_NEAR(report.clock_check->offset_s, -4.0, 0.3);
}

// Kills a search that ends near zero.
TEST(SonarChecks, AClockThatIsMinutesOffIsNamedWithItsOffset) {
  const SlamReport report = report_of(wander, late(100.0), 3000);
  ASSERT_TRUE(report.clock_check);
  EXPECT_NEAR(report.clock_check->offset_s, -100.0, 0.3);
  EXPECT_FALSE(report.clock_check->is_one_of_several);
  EXPECT_TRUE(names_the_clock(report));
}

TEST(SonarChecks, WithoutTurnsOrMatchingTheClockIsNotChecked) {
  const SlamReport still = report_of([](double) { return 0.7; }, late(5.0));
  EXPECT_FALSE(still.clock_check);
  SlamOptions alone = late(5.0);
  alone.matching = Matching::kNone;
  EXPECT_FALSE(report_of(wander, alone).clock_check);
}

}  // namespace
}  // namespace pingvox
