// Poses that go where no vehicle goes.

#include "nav/internal/trajectory_steps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <utility>
#include <vector>

namespace pingvox::test {
namespace {

/// Ten poses a second of a vehicle that goes ahead at 0.5 m/s, but for what is added to a pose.
Trajectory path_with(int count, const std::function<double(int)>& added_m) {
  std::vector<StampedPose> poses;
  for (int i = 0; i < count; ++i) {
    poses.push_back({0.1 * i, pose_from_rpy({0.05 * i + added_m(i), 0.0, -1.0}, 0.0, 0.0, 0.01 * i)});
  }
  return *Trajectory::make(std::move(poses));
}

TEST(TrajectorySteps, APathWithoutAnyStaysAsItIs) {
  const Trajectory path = path_with(300, [](int) { return 0.0; });
  const CutTrajectory cut = cut_at_steps(path);
  EXPECT_TRUE(cut.steps.empty());
  EXPECT_TRUE(cut.trajectory.cuts().empty());
  EXPECT_EQ(cut.trajectory.poses().size(), 300U);
  const CutTrajectory still = cut_at_steps(Trajectory::still(Pose::Identity()));
  EXPECT_TRUE(still.trajectory.at(1e9));
}

// One pose 20 m aside put two beams, and all between them, there.
TEST(TrajectorySteps, OutliersAreLeftOutAndTheirTimeIsBridged) {
  const CutTrajectory cut = cut_at_steps(path_with(300, [](int i) { return i == 150 || i == 220 ? 20.0 : 0.0; }));
  EXPECT_EQ(cut.trajectory.poses().size(), 298U);
  EXPECT_EQ(cut.trajectory.gaps(), 0U);
  ASSERT_EQ(cut.steps.size(), 2U);
  EXPECT_EQ(cut.steps[0].left_out, 1U);
  EXPECT_NEAR(cut.steps[0].to_s, 15.0, 1e-9);
  EXPECT_NEAR(cut.steps[0].moved_m, 20.05, 1e-9);
  const auto pose = cut.trajectory.at(15.0);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->translation().x(), 7.5, 1e-9);
}

// The loop that SLAM closes moves all later poses: they are right, but on the way between nothing is.
TEST(TrajectorySteps, ALastingStepCutsThePathAndLosesNothing) {
  const CutTrajectory cut = cut_at_steps(path_with(300, [](int i) { return i >= 150 ? 40.0 : 0.0; }));
  EXPECT_EQ(cut.trajectory.poses().size(), 300U);
  EXPECT_EQ(cut.trajectory.cuts(), std::vector<std::size_t>{150});
  EXPECT_EQ(cut.trajectory.gaps(), 1U);
  ASSERT_EQ(cut.steps.size(), 1U);
  EXPECT_EQ(cut.steps[0].left_out, 0U);
  EXPECT_NEAR(cut.steps[0].moved_m, 40.05, 1e-9);
  EXPECT_TRUE(cut.trajectory.at(14.9));
  EXPECT_FALSE(cut.trajectory.at(14.95));
  ASSERT_TRUE(cut.trajectory.at(15.0));
  EXPECT_NEAR(cut.trajectory.at(15.05)->translation().x(), 47.525, 1e-9);
}

TEST(TrajectorySteps, ATurnAtOnceIsAStep) {
  std::vector<StampedPose> poses;
  for (int i = 0; i < 100; ++i) {
    poses.push_back({0.1 * i, pose_from_rpy({0.0, 0.0, 0.0}, 0.0, 0.0, i >= 50 ? 2.0 : 0.0)});
  }
  const CutTrajectory cut = cut_at_steps(*Trajectory::make(std::move(poses)));
  EXPECT_EQ(cut.trajectory.cuts(), std::vector<std::size_t>{50});
  EXPECT_NEAR(cut.steps.at(0).turned_rad, 2.0, 1e-9);
}

TEST(TrajectorySteps, OutliersAtTheEndsAndAtACutAreLeftOut) {
  const CutTrajectory ends = cut_at_steps(path_with(300, [](int i) { return i == 0 || i == 299 ? 20.0 : 0.0; }));
  EXPECT_EQ(ends.trajectory.poses().size(), 298U);
  EXPECT_EQ(ends.trajectory.gaps(), 0U);
  EXPECT_FALSE(ends.trajectory.at(0.0));
  const CutTrajectory between = cut_at_steps(path_with(300, [](int i) {
    return i < 150 ? 0.0 : i == 150 ? 20.0 : 60.0;
  }));
  EXPECT_EQ(between.trajectory.poses().size(), 299U);
  EXPECT_EQ(between.trajectory.cuts(), std::vector<std::size_t>{150});
  EXPECT_FALSE(between.trajectory.at(15.0));
}

TEST(TrajectorySteps, SomethingIsLeftOfAPathOfJumps) {
  const CutTrajectory cut = cut_at_steps(path_with(20, [](int i) { return 100.0 * i * i; }));
  EXPECT_FALSE(cut.trajectory.poses().empty());
  EXPECT_EQ(cut.trajectory.cuts().size() + 1, cut.trajectory.poses().size());
}

// Kills odometry that moves the vehicle by the step.
TEST(TrajectorySteps, AJoinedPathGoesOnWhereItWas) {
  const Trajectory path = cut_at_steps(path_with(300, [](int i) { return i >= 150 ? 40.0 : 0.0; })).trajectory;
  const Trajectory joined = join_at_cuts(path);
  EXPECT_TRUE(joined.cuts().empty());
  const auto before = joined.at(14.9), after = joined.at(15.0), end = joined.at(29.9);
  ASSERT_TRUE(before && after && end);
  EXPECT_TRUE(after->isApprox(*before, 1e-9));
  EXPECT_NEAR((end->translation() - before->translation()).norm(), 14.9 * 0.5, 0.02);
}

}  // namespace
}  // namespace pingvox::test
