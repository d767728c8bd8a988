#include "pingvox/recording/fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/tum.hpp"
#include "recording/dive.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;

/// A drive round a tank, whose head is turned on its mount.
Dive tank_drive(const Pose& body_from_sensor) {
  const Scene scene = tank_scene({});
  SonarOptions sonar;
  sonar.beams_per_turn = 100;
  sonar.bins = 200;
  sonar.bin_length_m = 0.04;
  sonar.body_from_sensor = body_from_sensor;
  const Trajectory truth = follow_route(scene.loop, 60.0, {});
  SonarSimulator beams(scene.world, truth, sonar, 12);
  std::ostringstream log, path;
  EXPECT_TRUE(write_csv(beams, log));
  EXPECT_TRUE(write_tum(truth, path));
  return {{"dive.csv", bytes_of(log.str())}, {"dive.tum", bytes_of(path.str())}, truth};
}

Result<Fit> fit_of(const Dive& dive, FitParameter parameter) {
  const auto recording = Recording::open({dive.log}, {.poses = dive.nav});
  EXPECT_TRUE(recording);
  return fit(*recording, *recording->path(), parameter);
}

// Kills a mount that is turned the other way, and one that is fitted although nothing tells it.
TEST(Fit, FindsAHeadThatIsTurnedOnItsMount) {
  const Result<Fit> found =
      fit_of(tank_drive(pose_from_rpy({0, 0, 0}, 0.0, 0.0, 4.0 * kDegree_rad)), FitParameter::kMountYaw);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_TRUE(found->is_observable);
  EXPECT_NEAR(found->values.front().value, 4.0 * kDegree_rad, 0.5 * kDegree_rad);
  EXPECT_GT(found->score, found->score_before);
}

// Kills x and y that are searched one after the other from far away: each leads the other astray.
TEST(Fit, FindsAHeadThatIsMountedElsewhere) {
  const Result<Fit> found = fit_of(tank_drive(pose_from_rpy({0.28, -0.27, 0}, 0.0, 0.0, 0.0)), FitParameter::kMountXy);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_TRUE(found->is_observable);
  ASSERT_EQ(found->values.size(), 2U);
  EXPECT_NEAR(found->values[0].value, 0.28, 0.03);
  EXPECT_NEAR(found->values[1].value, -0.27, 0.03);
}

// Kills a deviation without what all parts of a recording share: walls that slant are heard nearer than they are.
TEST(Fit, ASpeedOfSoundIsNoSurerThanTheBeamIsNarrow) {
  const Result<Fit> found = fit_of(tank_drive(Pose::Identity()), FitParameter::kSoundSpeed);
  ASSERT_TRUE(found) << found.error().message;
  const Estimate& speed = found->values.front();
  EXPECT_NEAR(speed.value, 1.0, 2.0 * speed.deviation);
  EXPECT_GT(speed.deviation, 0.01);
}

// Kills a speed of sound that is told although a head that stands still hears the same tank, larger.
TEST(Fit, SaysSoWhenTheLogCannotTell) {
  SonarOptions sonar;
  sonar.beams_per_turn = 100;
  sonar.bins = 300;
  sonar.bin_length_m = 0.03;
  SonarSimulator beams(tank_scene({}).world, Trajectory::still(Pose::Identity()), sonar, 5);
  std::ostringstream log;
  EXPECT_TRUE(write_csv(beams, log));
  const auto recording = Recording::open({FileBytes{"tank.csv", bytes_of(log.str())}});
  ASSERT_TRUE(recording);
  const Result<Fit> found = fit(*recording, still_path(), FitParameter::kMountYaw);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_FALSE(found->is_observable);
}

TEST(Fit, NeedsFourSweeps) {
  SonarOptions sonar;
  sonar.beams_per_turn = 60;
  SonarSimulator beams(tank_scene({}).world, Trajectory::still(Pose::Identity()), sonar, 2);
  std::ostringstream log;
  EXPECT_TRUE(write_csv(beams, log));
  const auto recording = Recording::open({FileBytes{"tank.csv", bytes_of(log.str())}});
  ASSERT_TRUE(recording);
  const Result<Fit> found = fit(*recording, still_path(), FitParameter::kSoundSpeed);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, Error::Code::kUnsupported);
  EXPECT_THAT(found.error().message, HasSubstr("too few"));
}

}  // namespace
}  // namespace pingvox::test
