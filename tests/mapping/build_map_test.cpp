#include "pingvox/mapping/build_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "pingvox/map/cast_ray.hpp"

namespace pingvox {
namespace {

constexpr int kBeamsPerTurn = 200;
constexpr double kShortBin_m = 0.0125;

/// Turns of a head that hears one clean echo where `range_of(time, bearing)` says; none for a range <= 0.
class Echoes : public BeamSource {
 public:
  Echoes(int beams, std::function<double(double, double)> range_of) : beams_(beams), range_of_(std::move(range_of)) {}

  Result<std::optional<Beam>> next() override {
    if (fail_at_ == n_) return fail(Error::Code::kIo, "log.csv: line 7: disk fell off");
    if (n_ == beams_) return std::nullopt;
    Beam beam;
    beam.time_s = 0.04 * n_;
    beam.bearing_rad = 2.0 * std::numbers::pi * (n_ % kBeamsPerTurn) / kBeamsPerTurn;
    beam.bin_length_m = kShortBin_m;
    beam.intensities.assign(400, 5);
    const double range_m = range_of_(beam.time_s, beam.bearing_rad);
    if (range_m > 0.0) {
      const auto bin = static_cast<std::size_t>(range_m / kShortBin_m);
      for (std::size_t i = bin; i < bin + 3 && i < beam.intensities.size(); ++i) beam.intensities[i] = 200;
    }
    ++n_;
    return beam;
  }

  void fail_at(int n) { fail_at_ = n; }

 private:
  int beams_;
  std::function<double(double, double)> range_of_;
  int n_ = 0;
  int fail_at_ = -1;
};

/// The same, and something louder behind it.
class EchoesBeforeLouderOnes : public Echoes {
 public:
  EchoesBeforeLouderOnes(double range_m, double louder_m)
      : Echoes(kBeamsPerTurn, [=](double, double) { return range_m; }), louder_m_(louder_m) {}

  Result<std::optional<Beam>> next() override {
    Result<std::optional<Beam>> beam = Echoes::next();
    const auto bin = static_cast<std::size_t>(louder_m_ / kShortBin_m);
    if (beam && *beam) std::fill_n((*beam)->intensities.begin() + static_cast<std::ptrdiff_t>(bin), 3, 250);
    return beam;
  }

 private:
  double louder_m_;
};

BuildOptions clean_options() {
  BuildOptions options;
  options.filter.filter = Filter::kNone;
  options.model.shape = BeamShape::kRay;
  options.model.hit_from = HitFrom::kFixed;
  return options;
}

TEST(BuildMap, StillSensorInARoundTankMapsItsWall) {
  Echoes source(2 * kBeamsPerTurn + 7, [](double, double) { return 2.0; });
  OccupancyMap map;
  const auto report = build_map(source, Trajectory::still(Pose::Identity()), clean_options(), map);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->beams, 407U);
  EXPECT_EQ(report->echoes, 407U);
  EXPECT_EQ(report->sweeps, 2U);
  EXPECT_EQ(report->skipped, 0U);
  EXPECT_GT(report->cells_freed, 3'000U);
  for (int degrees = 0; degrees < 360; degrees += 9) {
    const double bearing = degrees * std::numbers::pi / 180.0;
    const Eigen::Vector3d way(std::cos(bearing), std::sin(bearing), 0.0);
    EXPECT_EQ(map.classify(way * 1.5), Occupancy::kFree) << degrees;
    EXPECT_EQ(map.classify(way * 2.5), Occupancy::kUnknown) << degrees;
  }
  EXPECT_EQ(map.classify(Eigen::Vector3d(2.01, 0.01, 0.01)), Occupancy::kOccupied);
}

// Kills one pose for a whole sweep: a vehicle that moves by 1.6 m in a turn would bend the wall.
TEST(BuildMap, BeamsOfAMovingVehicleArePlacedWhereTheyWereHeard) {
  constexpr double kSpeed_m_s = 0.2, kWall_m = 3.02;
  Echoes source(kBeamsPerTurn, [](double time, double bearing) {
    const double ahead = kWall_m - kSpeed_m_s * time;
    return std::cos(bearing) > 0.3 ? ahead / std::cos(bearing) : 0.0;
  });
  const auto moving =
      Trajectory::make({{0.0, Pose::Identity()}, {10.0, pose_from_rpy({10.0 * kSpeed_m_s, 0.0, 0.0}, 0.0, 0.0, 0.0)}});
  ASSERT_TRUE(moving);
  OccupancyMap map;
  const auto report = build_map(source, *moving, clean_options(), map);
  ASSERT_TRUE(report);
  const auto bounds = map.bounds();
  ASSERT_TRUE(bounds);
  EXPECT_NEAR(bounds->max.x(), kWall_m, 0.08);
  std::size_t walls = 0;
  for (double y = -2.0; y < 2.0; y += 0.05) {
    bool found = false;
    for (double x = kWall_m - 0.05; x < kWall_m + 0.1; x += 0.025) {
      found |= map.classify(Eigen::Vector3d(x, y + 0.025, 0.01)) == Occupancy::kOccupied;
    }
    walls += found;
    EXPECT_NE(map.classify(Eigen::Vector3d(kWall_m - 0.3, y + 0.025, 0.01)), Occupancy::kOccupied);
  }
  EXPECT_GT(walls, 30U);
}

TEST(BuildMap, MountIsAppliedBetweenBodyAndSensor) {
  Echoes source(kBeamsPerTurn, [](double, double bearing) { return bearing < 0.01 ? 2.0 : 0.0; });
  BuildOptions options = clean_options();
  options.body_from_sensor = pose_from_rpy({1.0, 0.0, -0.5}, 0.0, 0.0, std::numbers::pi / 2);
  OccupancyMap map;
  ASSERT_TRUE(build_map(source, Trajectory::still(Pose::Identity()), options, map));
  EXPECT_EQ(map.classify(Eigen::Vector3d(1.01, 2.01, -0.49)), Occupancy::kOccupied);
  // A vehicle that is turned itself: the mount turns with it.
  Echoes again(kBeamsPerTurn, [](double, double bearing) { return bearing < 0.01 ? 2.0 : 0.0; });
  const Pose vehicle = pose_from_rpy({10.02, 0.02, 0.02}, 0.0, 0.0, std::numbers::pi / 2);
  OccupancyMap turned;
  ASSERT_TRUE(build_map(again, Trajectory::still(vehicle), options, turned));
  EXPECT_EQ(turned.classify(Eigen::Vector3d(8.02, 1.02, -0.48)), Occupancy::kOccupied);
}

// Kills walls that are freed by their own second echo: the head stands 0.4 m before the wall, hears nothing of it
// within the blanking range, and then something at 3 m.
TEST(BuildMap, WhatIsHeardPastAnObstacleWithinTheBlankingRangeIsLeftOut) {
  constexpr double kTurn_s = 0.04 * kBeamsPerTurn;
  Echoes source(2 * kBeamsPerTurn, [](double time, double) { return time < kTurn_s - 0.01 ? 2.0 : 3.0; });
  const Pose near_wall = pose_from_rpy({1.6, 0.0, 0.0}, 0.0, 0.0, 0.0);
  const auto way = Trajectory::make({{0.0, Pose::Identity()},
                                     {kTurn_s - 0.02, Pose::Identity()},
                                     {kTurn_s - 0.01, near_wall},
                                     {3.0 * kTurn_s, near_wall}});
  ASSERT_TRUE(way);
  BuildOptions options = clean_options();
  OccupancyMap map;
  const auto report = build_map(source, *way, options, map);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(map.classify(Eigen::Vector3d(2.01, 0.01, 0.01)), Occupancy::kOccupied);
  EXPECT_EQ(map.classify(Eigen::Vector3d(3.01, 0.01, 0.01)), Occupancy::kUnknown);
  const auto behind_m = [&](double y) { return cast_ray(map, {1.59, y, 0.01}, {-1.0, 0.0, 0.0}, 5.0).range_m; };
  EXPECT_NEAR(std::min(behind_m(-0.01), behind_m(0.01)), 3.0, 0.1) << "the other side is mapped";
  EXPECT_GT(report->blocked.count, 10U);
  EXPECT_EQ(report->beams + report->blocked.count, 2U * kBeamsPerTurn);
  EXPECT_EQ(report->skipped, report->blocked.count);
}

// Kills beams that are left out because the cell of their own wall, or of one behind the head, begins within the
// blanking range.
TEST(BuildMap, WallBeyondTheBlankingRangeDoesNotBlockInCoarseCells) {
  for (const double resolution_m : {0.1, 0.5, 1.0}) {
    Echoes source(2 * kBeamsPerTurn, [](double, double) { return 0.9; });
    OccupancyMap map({.resolution_m = resolution_m});
    const auto report = build_map(source, Trajectory::still(Pose::Identity()), clean_options(), map);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(report->blocked.count, 0U) << resolution_m;
    EXPECT_EQ(report->beams, 2U * kBeamsPerTurn);
  }
}

TEST(BuildMap, BeamsOutsideOfTheTrajectoryAreLeftOutAndCounted) {
  Echoes source(kBeamsPerTurn, [](double, double) { return 2.0; });
  const auto known = Trajectory::make({{2.0, Pose::Identity()}, {4.0, Pose::Identity()}});
  OccupancyMap map;
  const auto report = build_map(source, *known, clean_options(), map);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->beams, 51U);
  EXPECT_EQ(report->skipped, 149U);
}

// In a sweep a hit beats the misses of its neighbours; beam by beam they take turns.
TEST(BuildMap, UpdatesPerSweepAndPerBeamDiffer) {
  // Neighbouring beams alternate between 2 m and 3 m: the far ones pass the near ones' cells.
  const auto alternating = [](double time, double) { return std::lround(time / 0.04) % 2 == 0 ? 0.9 : 3.0; };
  BuildOptions options = clean_options();
  options.model.shape = BeamShape::kFan;
  options.model.hit = LogOdds::from_probability(0.55);
  OccupancyMap per_sweep, per_beam;
  Echoes first(kBeamsPerTurn, alternating), second(kBeamsPerTurn, alternating);
  ASSERT_TRUE(build_map(first, Trajectory::still(Pose::Identity()), options, per_sweep));
  options.vote = Vote::kPerBeam;
  ASSERT_TRUE(build_map(second, Trajectory::still(Pose::Identity()), options, per_beam));
  EXPECT_GT(per_sweep.counts().occupied_cells, per_beam.counts().occupied_cells);
}

TEST(BuildMap, SoundSpeedScalesRanges) {
  Echoes source(kBeamsPerTurn, [](double, double) { return 2.0; });
  BuildOptions options = clean_options();
  options.sound_speed_ratio = 1.1;
  OccupancyMap map;
  ASSERT_TRUE(build_map(source, Trajectory::still(Pose::Identity()), options, map));
  EXPECT_EQ(map.classify(Eigen::Vector3d(2.21, 0.01, 0.01)), Occupancy::kOccupied);
}

// Kills a maximum range that only the model knows: the loudest bin of all would free the wall before it.
TEST(BuildMap, WhatIsLouderBeyondTheMaximumRangeHidesNoEcho) {
  EchoesBeforeLouderOnes source(1.51, 4.0);
  BuildOptions options = clean_options();
  options.echo.detector = Detector::kMax;
  options.echo.max_range_m = 2.0;
  OccupancyMap map;
  const auto report = build_map(source, Trajectory::still(Pose::Identity()), options, map);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->echoes, report->beams);
  EXPECT_EQ(map.classify(Eigen::Vector3d(1.51, 0.01, 0.01)), Occupancy::kOccupied);
  EXPECT_EQ(map.classify(Eigen::Vector3d(1.81, 0.01, 0.01)), Occupancy::kUnknown);
}

// Kills a beam that says nothing because what it heard is too far away to be mapped, and one counted as an echo.
TEST(BuildMap, WhatIsHeardBeyondTheMaximumRangeFreesUpToIt) {
  Echoes source(kBeamsPerTurn, [](double, double) { return 4.0; });
  BuildOptions options = clean_options();
  options.echo.max_range_m = 2.0;
  OccupancyMap map;
  const auto report = build_map(source, Trajectory::still(Pose::Identity()), options, map);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->echoes, 0U);
  EXPECT_EQ(map.counts().occupied_cells, 0U);
  EXPECT_EQ(map.classify(Eigen::Vector3d(1.91, 0.01, 0.01)), Occupancy::kFree);
  EXPECT_EQ(map.classify(Eigen::Vector3d(2.06, 0.01, 0.01)), Occupancy::kUnknown);
}

TEST(BuildMap, BeamsWantAMaximumRangeBeyondTheBlankingRange) {
  Echoes source(kBeamsPerTurn, [](double, double) { return 2.0; });
  BuildOptions options = clean_options();
  options.echo.max_range_m = 0.5;
  OccupancyMap map;
  const auto report = build_map(source, Trajectory::still(Pose::Identity()), options, map);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, Error::Code::kBadOption);
  EXPECT_NE(report.error().message.find("max_range_m"), std::string::npos);
  EXPECT_TRUE(map.empty());
}

TEST(BuildMap, FailingSourceIsReportedAndTheMapKeepsWhatWasApplied) {
  Echoes source(3 * kBeamsPerTurn, [](double, double) { return 2.0; });
  source.fail_at(kBeamsPerTurn + 50);
  OccupancyMap map;
  const auto report = build_map(source, Trajectory::still(Pose::Identity()), clean_options(), map);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().message, "log.csv: line 7: disk fell off");
  EXPECT_FALSE(map.empty());
}

TEST(BuildMap, MemoryLimitStopsTheRunWithTheMapBeforeTheScan) {
  Echoes source(kBeamsPerTurn, [](double, double) { return 2.0; });
  OccupancyMap map({.memory_limit_bytes = 2'000});
  const auto report = build_map(source, Trajectory::still(Pose::Identity()), clean_options(), map);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, Error::Code::kLimit);
  EXPECT_TRUE(map.empty());
}

// Kills a run that takes all memory because of one wrong word.
TEST(BuildMap, CellsTooSmallForTheBeamAreRefused) {
  Echoes source(kBeamsPerTurn, [](double, double) { return 2.0; });
  BuildOptions options = clean_options();
  options.model.shape = BeamShape::kCone;
  OccupancyMap map({.resolution_m = 1e-6, .depth = 32});
  const auto report = build_map(source, Trajectory::still(Pose::Identity()), options, map);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, Error::Code::kLimit);
  EXPECT_NE(report.error().message.find("larger cells"), std::string::npos);
  EXPECT_THAT(report.error().message, ::testing::ContainsRegex(" at [0-9]+\\.[0-9][0-9][0-9] s "));  // not 17 digits
}

// Rays were not checked: 15 s, and then no memory.
TEST(BuildMap, CellsTooSmallForARayAreRefused) {
  Echoes source(kBeamsPerTurn, [](double, double) { return 2.0; });
  BuildOptions options = clean_options();
  options.model.shape = BeamShape::kRay;
  OccupancyMap map({.resolution_m = 1e-6, .depth = 32});
  const auto report = build_map(source, Trajectory::still(Pose::Identity()), options, map);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, Error::Code::kLimit);
  EXPECT_THAT(report.error().message, ::testing::HasSubstr("cells of 1e-06 m long, and 1e+06 are the most"));
}

/// One scan of three points.
class ThreePoints : public ScanSource {
 public:
  Result<std::optional<PointScan>> next() override {
    if (std::exchange(given_, true)) return std::nullopt;
    return PointScan{{0.05, 0.05, 0.05}, {{1.05, 0.05, 0.05}, {0.05, 2.05, 0.05}, {1e9, 0.0, 0.0}}};
  }

 private:
  bool given_ = false;
};

TEST(BuildMap, PointScansFreeAndHitAndCountWhatLiesOutside) {
  ThreePoints source;
  OccupancyMap map({.resolution_m = 0.1});
  const auto report = build_map(source, Trajectory::still(Pose::Identity()), clean_options(), map);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->sweeps, 1U);
  EXPECT_EQ(report->skipped, 1U);
  EXPECT_EQ(report->cells_hit, 2U);
  EXPECT_EQ(report->cells_freed, 29U);
}

// Kills a blanking range asked of points, which have none.
TEST(BuildMap, PointScansTakeAnyMaximumRange) {
  ThreePoints source;
  BuildOptions options = clean_options();
  options.echo.max_range_m = 0.5;
  OccupancyMap map({.resolution_m = 0.1});
  const auto report = build_map(source, Trajectory::still(Pose::Identity()), options, map);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->cells_hit, 0U);
  EXPECT_GT(report->cells_freed, 0U);
}

// Kills a cloud far away that takes all memory for its rays.
TEST(BuildMap, PointsFarFromTheirOriginAreRefused) {
  ThreePoints source;
  OccupancyMap map({.resolution_m = 0.1, .depth = 40});
  const auto report = build_map(source, Trajectory::still(Pose::Identity()), clean_options(), map);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, Error::Code::kLimit);
  EXPECT_THAT(report.error().message, ::testing::HasSubstr("a ray of 1e+09 m has 1.0e+10 cells of 0.1 m"));
  EXPECT_TRUE(map.empty());
}

/// One scan of the points ahead and to port, seen from the sensor at a time.
class TimedScan : public ScanSource {
 public:
  enum class PointsIn { kSensor, kMap };
  explicit TimedScan(double time_s, PointsIn in = PointsIn::kSensor) : time_s_(time_s), in_(in) {}

  Result<std::optional<PointScan>> next() override {
    if (std::exchange(given_, true)) return std::nullopt;
    PointScan scan{.points_m = {{2.0, 0.0, 0.0}, {0.0, 3.0, 0.0}}};
    scan.time_s = time_s_;
    scan.has_points_in_map = in_ == PointsIn::kMap;
    return scan;
  }

 private:
  double time_s_;
  PointsIn in_;
  bool given_ = false;
};

// Kills points that move with the vehicle though they are in the map, and rays from the origin.
TEST(BuildMap, PointsOfTheMapAreSeenFromTheTrajectory) {
  const auto path = Trajectory::make(
      {{10.0, Pose(Eigen::Translation3d(2.05, -2.05, 0.05))}, {12.0, Pose(Eigen::Translation3d(2.05, -2.05, 0.05))}});
  ASSERT_TRUE(path);
  OccupancyMap map({.resolution_m = 0.1});
  TimedScan source(11.0, TimedScan::PointsIn::kMap);
  ASSERT_TRUE(build_map(source, *path, clean_options(), map));
  EXPECT_EQ(map.classify(Eigen::Vector3d(2.025, 0.025, 0.025)), Occupancy::kOccupied);
  EXPECT_EQ(map.classify(Eigen::Vector3d(2.05, -1.025, 0.05)), Occupancy::kFree) << "from where the sensor was";
  EXPECT_EQ(map.classify(Eigen::Vector3d(1.025, 0.025, 0.025)), Occupancy::kUnknown) << "not from the origin";
}

// Kills scans mapped at the origin, with a mount on the wrong side, or at the pose of another time.
TEST(BuildMap, ScansWithATimeArePlacedAlongTheTrajectory) {
  const Pose quarter_turn = pose_from_rpy(Eigen::Vector3d::Zero(), 0.0, 0.0, std::numbers::pi / 2.0);
  const auto path =
      Trajectory::make({{10.0, quarter_turn}, {12.0, Pose(Eigen::Translation3d(4.05, 0.05, 0.05)) * quarter_turn}});
  ASSERT_TRUE(path);
  BuildOptions options = clean_options();
  options.body_from_sensor = Pose(Eigen::Translation3d(1.0, 0.0, 0.0));
  OccupancyMap map({.resolution_m = 0.1});
  TimedScan source(11.0);
  const auto report = build_map(source, *path, options, map);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->first_s, 11.0);
  EXPECT_EQ(report->no_pose.count, 0U);
  // Half way, at (2.025, 0.025, 0.025), the sensor is one metre ahead of it, which is along y.
  EXPECT_EQ(map.classify(Eigen::Vector3d(2.025, 3.025, 0.025)), Occupancy::kOccupied);
  EXPECT_EQ(map.classify(Eigen::Vector3d(-0.975, 1.025, 0.025)), Occupancy::kOccupied);
  EXPECT_EQ(map.classify(Eigen::Vector3d(2.025, 1.525, 0.025)), Occupancy::kFree);

  TimedScan too_late(12.5);
  const auto none = build_map(too_late, *path, options, map);
  ASSERT_TRUE(none);
  EXPECT_EQ(none->no_pose.count, 2U);
  EXPECT_EQ(none->no_pose.first_s, 12.5);
  EXPECT_EQ(none->skipped, 2U);
  EXPECT_EQ(none->cells_hit, 0U);
}

}  // namespace
}  // namespace pingvox
