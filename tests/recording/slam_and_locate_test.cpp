#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "pingvox/recording/recording.hpp"
#include "pingvox/slam/causal_replay.hpp"
#include "recording/dive.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;

// Kills an estimation of the other kind.
template <class Slam>
void expect_as_by(Estimation estimation) {
  const Dive dive = harbour_dive();
  const auto recording = Recording::open({dive.log}, {.nav = {dive.nav}, .nav_offset_s = 0.0});
  ASSERT_TRUE(recording) << recording.error().message;
  const auto found = slam(*recording, {}, estimation);
  ASSERT_TRUE(found) << found.error().message;

  Slam estimator{SlamOptions{}};
  ASSERT_TRUE(estimator.add(read_nav(dive.nav)->log));
  for (const Beam& beam : all_beams(dive.log).items) estimator.add(beam);
  const auto by_hand = estimator.solve();
  ASSERT_TRUE(by_hand) << by_hand.error().message;
  EXPECT_EQ(found->solution.report.largest.has_value(), estimation == Estimation::kCausal);
  const auto &a = found->solution.trajectory.poses(), &b = by_hand->trajectory.poses();
  ASSERT_EQ(a.size(), b.size());
  const Eigen::Vector3d moved = a.front().map_from_body.translation() - b.front().map_from_body.translation();
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].map_from_body.linear(), b[i].map_from_body.linear()) << i;
    const Eigen::Vector3d apart = a[i].map_from_body.translation() - b[i].map_from_body.translation();
    ASSERT_LT((apart - moved).norm(), 1e-9) << i;
  }
  // It begins where dead reckoning has the vehicle then.
  const auto path = recording->path();
  ASSERT_TRUE(path) << path.error().message;
  const auto is_known = [&](const StampedPose& pose) { return path->trajectory.at(pose.time_s).has_value(); };
  const auto first = std::ranges::find_if(a, is_known);
  ASSERT_NE(first, a.end());
  const Pose reckoned = *path->trajectory.at(first->time_s);
  EXPECT_LT((reckoned.translation() - first->map_from_body.translation()).norm(), 1e-9);
}

TEST(RecordingSlam, IsWhatASmootherSaysOfItsBeams) {
  expect_as_by<SlamSmoother>(Estimation::kBatch);
}

TEST(RecordingSlam, IsWhatAReplaySaysAsOnBoard) {
  expect_as_by<CausalReplay>(Estimation::kCausal);
}

// Kills a map that is not along the path of SLAM.
TEST(RecordingSlam, GivesThePathOfAMap) {
  const Dive dive = harbour_dive();
  const auto recording = Recording::open({dive.log}, {.nav = {dive.nav}});
  ASSERT_TRUE(recording) << recording.error().message;
  const auto found = slam(*recording);
  ASSERT_TRUE(found) << found.error().message;
  const auto mapped = build_map(*recording, found->path(), {.resolution_m = 0.2});
  ASSERT_TRUE(mapped) << mapped.error().message;
  EXPECT_EQ(mapped->report.no_pose.count + mapped->report.beams, all_beams(dive.log).items.size());
  EXPECT_GT(mapped->report.beams, 650U);
}

TEST(RecordingSlam, RefusesScans) {
  const FileBytes cloud{"cloud.xyz", bytes_of("1 2 3\n4 5 6\n")};
  const auto recording = Recording::open({cloud});
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_THAT(slam(*recording).error().message, HasSubstr("cloud.xyz: holds scans of points"));
}

TEST(RecordingLocation, FindsASonarInTheMapOfItsOwnLog) {
  const Scene scene = tank_scene({});
  SonarOptions sonar;
  sonar.beams_per_turn = 100;
  SonarSimulator simulator(scene.world, Trajectory::still(Pose::Identity()), sonar, 3);
  std::ostringstream log;
  ASSERT_TRUE(write_csv(simulator, log));
  const auto recording = Recording::open({FileBytes{"tank.csv", bytes_of(log.str())}});
  ASSERT_TRUE(recording);
  const auto mapped = build_map(*recording);
  ASSERT_TRUE(mapped) << mapped.error().message;
  const auto location = locate(*recording, mapped->map, {.locate = {.localizer = {}, .start = StartPose{0.2, 0.1}}});
  ASSERT_TRUE(location) << location.error().message;
  EXPECT_EQ(location->beams, 300U);
  ASSERT_FALSE(location->found.hypotheses.empty());
  EXPECT_NEAR(location->found.hypotheses.front().x_m, 0.0, 0.1);
  EXPECT_NEAR(location->found.hypotheses.front().y_m, 0.0, 0.1);
}

TEST(RecordingLocation, SaysWhereTheMapHasNoWalls) {
  const Dive dive = harbour_dive();
  const auto recording = Recording::open({dive.log});
  ASSERT_TRUE(recording);
  const auto location = locate(*recording, OccupancyMap());
  ASSERT_FALSE(location);
  EXPECT_THAT(location.error().message, HasSubstr("min_z_m"));
}

}  // namespace
}  // namespace pingvox::test
