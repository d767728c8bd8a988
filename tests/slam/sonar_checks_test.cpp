#include "slam/sonar_checks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "pingvox/slam/slam_smoother.hpp"
#include "tests/slam/room.hpp"

namespace pingvox {
namespace {

using test::Room;
using test::wander;
using testing::HasSubstr;
using Yaw = std::function<double(double)>;

/// Turns the same way once in 40 s, and not like a sine: that shifted by some seconds is nearly one with a smaller
/// amplitude.
double round_and_round(double time_s) {
  const double phase = 2.0 * std::numbers::pi * time_s / 40.0;
  return 0.4 * std::sin(phase) + 0.15 * std::sin(3.0 * phase + 1.0);
}

/// What the smoother reports of a vehicle that turns on the spot in a room, ten beams a second.
SlamReport report_of(const Yaw& yaw, const SlamOptions& options, int beams = 1500) {
  SlamSmoother smoother(options);
  for (int i = 0; i < beams; ++i) smoother.add(Room{}.beam(i, {0.4, -0.3, yaw(0.1 * i)}));
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

SlamOptions late(double offset_s, Estimation estimation) {
  SlamOptions options;
  options.nav_offset_s = offset_s;
  options.estimation = estimation;
  return options;
}

bool names_the_clock(const SlamReport& report) {
  return testing::Value(report.implausible, testing::Contains(HasSubstr("clock of compass")));
}

// Kills a wrong clock that is not named, a right one that is, and an offset of the wrong sign.
TEST(SonarChecks, AClockThatTheTurningOfThePictureContradictsIsImplausible) {
  for (const Estimation estimation : {Estimation::kBatch, Estimation::kCausal}) {
    for (const double offset_s : {0.0, 4.0, -4.0}) {
      const SlamReport report = report_of(wander, late(offset_s, estimation));
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
  const SlamReport report = report_of(round_and_round, late(5.0, Estimation::kBatch), kBeams);
  ASSERT_TRUE(report.clock_check);
  EXPECT_NEAR(report.clock_check->offset_s, -5.0, 0.5);
  EXPECT_TRUE(names_the_clock(report));
}

// Kills a search that ends near zero.
TEST(SonarChecks, AClockThatIsMinutesOffIsNamedWithItsOffset) {
  const SlamReport report = report_of(wander, late(100.0, Estimation::kBatch), 3000);
  ASSERT_TRUE(report.clock_check);
  EXPECT_NEAR(report.clock_check->offset_s, -100.0, 0.3);
  EXPECT_TRUE(names_the_clock(report));
}

TEST(SonarChecks, WithoutTurnsOrMatchingTheClockIsNotChecked) {
  const SlamReport still = report_of([](double) { return 0.7; }, late(5.0, Estimation::kBatch));
  EXPECT_FALSE(still.clock_check);
  SlamOptions alone = late(5.0, Estimation::kBatch);
  alone.matching = Matching::kNone;
  EXPECT_FALSE(report_of(wander, alone).clock_check);
}

}  // namespace
}  // namespace pingvox
