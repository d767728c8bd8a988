#include <gtest/gtest.h>

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "pingvox/analysis/compare.hpp"
#include "pingvox/mapping/build_map.hpp"
#include "pingvox/mapping/rebuilt_map.hpp"
#include "tests/mapping/room.hpp"

namespace pingvox {
namespace {

/// 60 beams to a turn.
std::vector<Beam> room(int beams) {
  return test::room(beams, 60, 150);
}

/// Where the vehicle was: along an arc, bent by a drift.
Pose pose_at(double time_s, double drift) {
  return pose_from_rpy({0.3 * time_s, drift * time_s * time_s, 0.01 * time_s}, 0.01, 0.02, 0.05 * time_s + drift);
}

Trajectory trajectory_of(const std::vector<Beam>& beams, std::size_t count, double drift) {
  std::vector<StampedPose> poses;
  for (std::size_t n = 0; n < count; ++n) poses.push_back({beams[n].time_s, pose_at(beams[n].time_s, drift)});
  return *Trajectory::make(std::move(poses));
}

struct Batch {
  OccupancyMap map;
  BuildReport report;
};

/// The map of all beams along a trajectory.
Batch batch(const std::vector<Beam>& beams, const Trajectory& trajectory, const BuildOptions& options) {
  Batch made{OccupancyMap({.resolution_m = 0.04}), {}};
  BeamsInMemory source(beams);
  const auto report = build_map(source, trajectory, options, made.map);
  EXPECT_TRUE(report) << report.error().message;
  if (report) made.report = *report;
  return made;
}

void expect_same(const RebuiltMap& rebuilt, const Batch& expected) {
  const auto compared = compare_maps(rebuilt.map(), expected.map, Sameness::kLogOdds);
  ASSERT_TRUE(compared);
  EXPECT_GT(compared->cells(), 5'000U);
  EXPECT_TRUE(compared->equal());
  EXPECT_EQ(rebuilt.map().counts().nodes(), expected.map.counts().nodes());
  EXPECT_EQ(rebuilt.report().beams, expected.report.beams);
  EXPECT_EQ(rebuilt.report().sweeps, expected.report.sweeps);
  EXPECT_EQ(rebuilt.report().echoes, expected.report.echoes);
  EXPECT_EQ(rebuilt.report().no_pose.count, expected.report.no_pose.count);
  EXPECT_EQ(rebuilt.report().cells_freed, expected.report.cells_freed);
}

RebuiltMap empty_map(const BuildOptions& options) {
  auto map = RebuiltMap::make(options, {.resolution_m = 0.04});
  EXPECT_TRUE(map) << map.error().message;
  return *std::move(map);
}

BuildOptions by_beam() {
  BuildOptions options;
  options.model.shape = BeamShape::kRay;
  options.timing = Timing::kByBeam;
  options.vote = Vote::kPerBeam;
  return options;
}

BuildOptions cones() {
  BuildOptions options;
  options.model.shape = BeamShape::kCone;
  options.sound_speed_ratio = 1.02;
  options.body_from_sensor = pose_from_rpy({0.013, 0.021, 0.0}, 0.02, 0.03, 0.1);
  return options;
}

// Kills beams that came meanwhile and are lost or taken twice, beams that waited for their echo and keep the old pose,
// another order of beams, a mount or a speed of sound that is applied again.
TEST(RebuiltMapThreads, IsTheBatchMapOfTheFinalTrajectoryToTheBit) {
  const std::vector<Beam> beams = room(500);
  for (const BuildOptions& options : {cones(), by_beam(), BuildOptions{}}) {
    RebuiltMap map = empty_map(options);
    double drift = 0.02;
    for (std::size_t n = 0; n < beams.size(); ++n) {
      if (n == 130 || n == 333) {
        drift = n == 130 ? 0.01 : 0.0;
        ASSERT_TRUE(map.correct(trajectory_of(beams, n, drift)));
        EXPECT_TRUE(map.is_rebuilding());
      }
      ASSERT_TRUE(map.add(beams[n], pose_at(beams[n].time_s, drift)));
    }
    ASSERT_TRUE(map.finish());
    ASSERT_TRUE(map.wait());
    EXPECT_FALSE(map.is_rebuilding());
    expect_same(map, batch(beams, trajectory_of(beams, beams.size(), 0.0), options));
  }
}

// Kills beams behind the end of a trajectory that stay where they were, or lose their pose.
TEST(RebuiltMapThreads, BeamsAfterTheEndOfTheTrajectoryAreMovedAsItsLastPose) {
  const std::vector<Beam> beams = room(300);
  RebuiltMap map = empty_map(cones());
  for (const Beam& beam : beams) ASSERT_TRUE(map.add(beam, pose_at(beam.time_s, 0.02)));
  const Trajectory known = trajectory_of(beams, 200, 0.0);
  ASSERT_TRUE(map.correct(known));
  ASSERT_TRUE(map.finish());
  ASSERT_TRUE(map.wait());

  const double end_s = known.poses().back().time_s;
  const Pose moved = pose_at(end_s, 0.0) * pose_at(end_s, 0.02).inverse();
  std::vector<StampedPose> poses = known.poses();
  for (std::size_t n = 200; n < beams.size(); ++n) {
    poses.push_back({beams[n].time_s, moved * pose_at(beams[n].time_s, 0.02)});
  }
  expect_same(map, batch(beams, *Trajectory::make(std::move(poses)), cones()));
}

// Kills beams without a pose that are dropped for good, and such that keep a pose that no trajectory has.
TEST(RebuiltMapThreads, ATrajectorySaysWhichPosesAreKnown) {
  const std::vector<Beam> beams = room(300);
  RebuiltMap map = empty_map(cones());
  for (std::size_t n = 0; n < beams.size(); ++n) {
    ASSERT_TRUE(map.add(beams[n], n < 60 ? std::nullopt : std::optional(pose_at(beams[n].time_s, 0.02))));
  }
  ASSERT_TRUE(map.finish());
  EXPECT_EQ(map.report().no_pose.count, 60U);
  std::vector<StampedPose> poses = trajectory_of(beams, 300, 0.0).poses();
  poses.erase(poses.begin(), poses.begin() + 30);
  const Trajectory known = *Trajectory::make(std::move(poses));
  ASSERT_TRUE(map.correct(known));
  ASSERT_TRUE(map.wait());
  EXPECT_EQ(map.report().no_pose.count, 30U);
  expect_same(map, batch(beams, known, cones()));
}

// Kills a correction that is forgotten because one is under way, and a thread that outlives its map.
TEST(RebuiltMapThreads, OfSeveralTrajectoriesTheLastCounts) {
  const std::vector<Beam> beams = room(200);
  RebuiltMap map = empty_map(cones());
  for (const Beam& beam : beams) ASSERT_TRUE(map.add(beam, pose_at(beam.time_s, 0.03)));
  ASSERT_TRUE(map.finish());
  for (const double drift : {0.02, 0.01, 0.0}) ASSERT_TRUE(map.correct(trajectory_of(beams, 200, drift)));
  ASSERT_TRUE(map.wait());
  expect_same(map, batch(beams, trajectory_of(beams, 200, 0.0), cones()));
  ASSERT_TRUE(map.correct(trajectory_of(beams, 200, 0.01)));
  RebuiltMap moved = std::move(map);
  EXPECT_TRUE(moved.is_rebuilding());
}

// Kills an error of the thread that nobody is told, and a map that is given up for one that failed.
TEST(RebuiltMapThreads, AMapThatCannotBeRebuiltStays) {
  const std::vector<Beam> beams = room(240);
  const auto stays = trajectory_of(beams, 1, 0.0).poses().front().map_from_body;
  std::vector<StampedPose> apart;
  for (std::size_t n = 0; n < beams.size(); ++n) {
    apart.push_back({beams[n].time_s, pose_from_rpy({0.5 * static_cast<double>(n), 0.0, 0.0}, 0.0, 0.0, 0.0)});
  }
  const Batch small = batch(beams, Trajectory::still(stays), cones());
  auto map =
      RebuiltMap::make(cones(), {.resolution_m = 0.04, .memory_limit_bytes = small.map.memory_bytes() + 200'000});
  ASSERT_TRUE(map);
  for (const Beam& beam : beams) ASSERT_TRUE(map->add(beam, stays));
  ASSERT_TRUE(map->finish());
  ASSERT_TRUE(map->correct(*Trajectory::make(std::move(apart))));
  const auto waited = map->wait();
  ASSERT_FALSE(waited);
  EXPECT_EQ(waited.error().code, Error::Code::kLimit);
  EXPECT_FALSE(map->is_rebuilding());
  expect_same(*map, small);
}

// Kills complete sweeps that are counted again after an error.
TEST(RebuiltMapThreads, CountsTheSweepsBeforeAndAfterAnError) {
  const std::vector<Beam> beams = room(6 * 60);
  const auto stays = trajectory_of(beams, 1, 0.0).poses().front().map_from_body;
  const Batch small = batch(beams, Trajectory::still(stays), cones());
  auto map =
      RebuiltMap::make(cones(), {.resolution_m = 0.04, .memory_limit_bytes = small.map.memory_bytes() + 200'000});
  ASSERT_TRUE(map);
  std::size_t refused = 0;
  for (std::size_t n = 0; n < beams.size(); ++n) {
    // The beams of the fourth sweep are so far apart that the map would grow too large.
    const bool is_apart = n >= 180 && n < 240;
    const Pose pose = is_apart ? pose_from_rpy({0.5 * static_cast<double>(n), 0.0, 0.0}, 0.0, 0.0, 0.0) : stays;
    if (!map->add(beams[n], pose)) ++refused;
  }
  EXPECT_EQ(refused, 1U);
  // Three, and the one that begins after the beam that was lost with the error.
  EXPECT_EQ(map->report().sweeps, 4U);
  ASSERT_TRUE(map->correct(Trajectory::still(stays)));
  ASSERT_TRUE(map->wait());
  EXPECT_EQ(map->report().sweeps, 4U);
}

}  // namespace
}  // namespace pingvox
