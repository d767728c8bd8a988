#include "pingvox/recording/mosaic.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "pingvox/io/beams.hpp"
#include "pingvox/io/tum.hpp"
#include "recording/dive.hpp"

namespace pingvox::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A dive through a tank of 4.5 m, along a path that is known.
Dive tank_dive(double clock_s = 0.0) {
  TankOptions tank;
  tank.sensor_x_m = tank.sensor_y_m = tank.sensor_yaw_rad = 0.0;
  tank.floater_radius_m = 0.0;
  const Scene scene = tank_scene(tank);
  std::vector<StampedPose> poses;
  for (int i = 0; i <= 40; ++i) {
    const double s = static_cast<double>(i);
    poses.push_back(
        {s + clock_s, pose_from_rpy({0.6 * std::sin(0.1 * s), 0.5 * std::cos(0.15 * s), 0}, 0, 0, 0.05 * s)});
  }
  SonarOptions sonar;
  sonar.bins = 300;
  sonar.bin_length_m = 0.0125;
  const Trajectory truth = *Trajectory::make(std::move(poses));
  SonarSimulator beams(scene.world, truth, sonar, 4);
  std::ostringstream log, path;
  EXPECT_TRUE(write_csv(beams, log));
  EXPECT_TRUE(write_tum(truth, path));
  return {{"tank.csv", bytes_of(log.str())}, {"tank.tum", bytes_of(path.str())}, truth};
}

Result<RecordingMosaic> mosaic_of(const std::vector<InputFile>& logs, const RecordingOptions& options,
                                  const RecordingMosaicOptions& how = {}) {
  const auto recording = Recording::open(logs, options);
  if (!recording) return tl::unexpected(recording.error());
  const auto path = recording->path();
  if (!path) return tl::unexpected(path.error());
  return mosaic(*recording, *path, how);
}

void expect_same(const Raster<float>& a, const Raster<float>& b) {
  ASSERT_EQ(a.columns, b.columns);
  ASSERT_EQ(a.rows, b.rows);
  EXPECT_EQ(a.corner_m, b.corner_m);
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    ASSERT_EQ(std::isnan(a.values[i]), std::isnan(b.values[i])) << i;
    if (!std::isnan(a.values[i])) {
      ASSERT_NEAR(a.values[i], b.values[i], 1e-3) << i;
    }
  }
}

TEST(RecordingMosaic, ShowsTheWallsOfATankWhereTheyAre) {
  const Dive dive = tank_dive();
  const auto made = mosaic_of({dive.log}, {.poses = dive.nav}, {.resolution_m = 0.05});
  ASSERT_TRUE(made) << made.error().message;
  constexpr double kWall_m = 2.25;
  double wall_sum = 0.0, water_sum = 0.0, walls = 0.0, waters = 0.0;
  for (std::size_t row = 0; row < made->picture.rows; ++row) {
    for (std::size_t column = 0; column < made->picture.columns; ++column) {
      const float value = made->picture.at(column, row);
      if (std::isnan(value)) continue;
      const double x = made->picture.corner_m.x() + 0.05 * (static_cast<double>(column) + 0.5);
      const double y = made->picture.corner_m.y() + 0.05 * (static_cast<double>(row) + 0.5);
      const double reach_m = std::max(std::abs(x), std::abs(y));
      if (std::abs(reach_m - kWall_m - 0.05) < 0.06) {
        wall_sum += static_cast<double>(value);
        walls += 1.0;
      } else if (reach_m < kWall_m - 0.3) {
        water_sum += static_cast<double>(value);
        waters += 1.0;
      }
    }
  }
  EXPECT_GT(walls, 300.0);
  EXPECT_GT(waters, 3000.0);
  EXPECT_GT(wall_sum / walls, 3.0 * water_sum / waters);
  EXPECT_GT(made->report.beams, 500U);
}

TEST(RecordingMosaic, IsTheSameAtAnotherTimeOfTheSameClock) {
  const Dive dive = tank_dive(), later = tank_dive(1000.0);
  const auto a = mosaic_of({dive.log}, {.poses = dive.nav}), b = mosaic_of({later.log}, {.poses = later.nav});
  ASSERT_TRUE(a) << a.error().message;
  ASSERT_TRUE(b) << b.error().message;
  expect_same(a->picture, b->picture);
}

TEST(RecordingMosaic, OfALogTwiceIsThatOfOne) {
  const Dive dive = tank_dive();
  const auto once = mosaic_of({dive.log}, {.poses = dive.nav});
  const auto twice = mosaic_of({dive.log, dive.log}, {.poses = dive.nav});
  ASSERT_TRUE(once && twice);
  expect_same(once->picture, twice->picture);
  EXPECT_EQ(twice->report.beams, 2 * once->report.beams);
}

TEST(RecordingMosaic, PlacesTheHeadByItsMount) {
  const Dive dive = tank_dive();
  const Pose mount = pose_from_rpy({0.4, 0.1, -0.2}, 0, 0, 0);
  // Poses of the head, and poses of the vehicle that carries it.
  std::vector<StampedPose> poses = dive.truth.poses();
  for (StampedPose& pose : poses) pose.map_from_body = pose.map_from_body * mount.inverse();
  std::ostringstream path;
  ASSERT_TRUE(write_tum(*Trajectory::make(poses), path));
  const auto a = mosaic_of({dive.log}, {.poses = dive.nav});
  const auto b =
      mosaic_of({dive.log}, {.poses = FileBytes{"body.tum", bytes_of(path.str())}, .body_from_sonar = mount});
  ASSERT_TRUE(a) << a.error().message;
  ASSERT_TRUE(b) << b.error().message;
  ASSERT_EQ(a->picture.columns, b->picture.columns);
  ASSERT_EQ(a->picture.rows, b->picture.rows);
  std::size_t different = 0;
  for (std::size_t i = 0; i < a->picture.values.size(); ++i) {
    const float x = a->picture.values[i], y = b->picture.values[i];
    different += std::isnan(x) ? (std::isnan(y) ? 0U : 1U) : std::abs(x - y) < 0.01F ? 0U : 1U;
  }
  // Between poses the head goes along another chord than the vehicle: a tenth of a millimetre, at the borders of beams.
  EXPECT_LT(different, a->picture.values.size() / 5);
}

TEST(RecordingMosaic, SaysWhyNothingCanBeDrawn) {
  const Dive dive = tank_dive();
  const auto late = mosaic_of({dive.log}, {.poses = tank_dive(1000.0).nav});
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().code, Error::Code::kCorrupt);
  EXPECT_THAT(late.error().message, AllOf(HasSubstr("tank.csv"), HasSubstr("outside the time of the poses, 1000")));
  const auto near = mosaic_of({dive.log}, {}, {.min_range_m = 100.0});
  ASSERT_FALSE(near);
  EXPECT_THAT(near.error().message, AllOf(HasSubstr("tank.csv"), HasSubstr("min_range_m")));
}

TEST(RecordingMosaic, OfAHeadThatStandsStillIsItsSweep) {
  const Dive dive = tank_dive();
  const auto made = mosaic_of({dive.log}, {}, {.resolution_m = 0.05});
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_NEAR(static_cast<double>(made->picture.columns), 2.0 * 3.75 / 0.05, 4.0);
  EXPECT_NEAR(made->picture.corner_m.x(), -3.75, 0.1);
}

}  // namespace
}  // namespace pingvox::test
