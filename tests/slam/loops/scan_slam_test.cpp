// A vehicle with a forward-looking sonar whose odometry drifts.

#include "pingvox/slam/scan_slam.hpp"

#include <gtest/gtest.h>

#include "pingvox/slam/pose_graph.hpp"
#include "slam/scanned_drive.hpp"
#include "support/rounds.hpp"

namespace pingvox::test {
namespace {

constexpr std::array<Wall, 12> kHarbour = {{{0, 0, 60, -4},
                                            {60, -4, 64, 30},
                                            {64, 30, 40, 34},
                                            {40, 34, 38, 50},
                                            {38, 50, -4, 46},
                                            {-4, 46, 0, 0},
                                            {20, -1, 21, 12},
                                            {21, 12, 24, 12},
                                            {24, 12, 24, -1},
                                            {-2, 28, 14, 29},
                                            {14, 29, 14, 33},
                                            {14, 33, -2, 33}}};
const std::vector<Eigen::Vector2d> kRound = {{8, 8},   {14, 20}, {34, 18}, {52, 10}, {54, 24}, {30, 26},
                                             {10, 20}, {8, 8},   {14, 20}, {34, 18}, {52, 10}, {54, 24}};

ScanSlamSolution solution_of(const ScannedDrive& drive) {
  ScanSlam slam;
  for (const PointScan& scan : drive.scans) slam.add(scan);
  auto solution = slam.solve();
  EXPECT_TRUE(solution) << (solution ? "" : solution.error().message);
  return std::move(*solution);
}

double rmse_m(const ScannedDrive& drive, const ScanSlamSolution& solution) {
  const auto poses = solution.trajectory.poses();
  EXPECT_EQ(poses.size(), drive.truth.size());
  return drive.rmse_m([&](std::size_t i) { return Eigen::Vector2d(poses[i].map_from_body.translation().head<2>()); });
}

TEST(ScanSlam, CorrectsTheDriftWhereTheVehicleComesBack) {
  const ScannedDrive drive(kHarbour, kRound, {});
  const ScanSlamSolution solution = solution_of(drive);
  EXPECT_GT(drive.odometry_rmse_m(), 3.0);
  EXPECT_LT(rmse_m(drive, solution), 1.5);
  EXPECT_GT(solution.report.loops_kept, 20U);
  EXPECT_EQ(solution.report.scans, drive.scans.size());
  EXPECT_EQ(solution.trajectory.poses()[7].time_s, 7.0);
  EXPECT_EQ(solution.trajectory.poses()[7].map_from_body.translation().z(), -1.0);
}

// Kills edges of other nodes or in the other direction, and loops that are written with more than they count.
TEST(ScanSlam, PlainLeastSquaresOverItsGraphGiveItsPoses) {
  PINGVOX_SKIP_UNDER_SANITIZERS();
  const ScannedDrive drive(kHarbour, kRound, {});
  const ScanSlamSolution solution = solution_of(drive);
  const PoseGraph& graph = solution.graph;
  ASSERT_EQ(graph.nodes.size(), solution.report.key_frames);
  EXPECT_EQ(graph.edges.size(), graph.nodes.size() - 1 + solution.report.loops_kept);
  const std::vector<PoseEdge>& edges = graph.edges;
  // From where the odometry alone leads.
  std::vector<Pose2> poses = {graph.nodes[0].pose};
  for (std::size_t k = 0; k + 1 < graph.nodes.size(); ++k) {
    EXPECT_EQ(edges[k].b, k + 1);
    poses.push_back(poses.back() * edges[k].a_from_b);
  }
  EXPECT_GT((poses.back().place_m - graph.nodes.back().pose.place_m).norm(), 2.0);
  solve_pose_graph(poses, edges, {});
  for (std::size_t k = 0; k < poses.size(); ++k) {
    EXPECT_LT((poses[k].place_m - graph.nodes[k].pose.place_m).norm(), 0.02) << k;
    // A key frame is its first scan.
    const Pose scan = *solution.trajectory.at(static_cast<double>(graph.nodes[k].number));
    EXPECT_LT((scan.translation().head<2>() - graph.nodes[k].pose.place_m).norm(), 1e-9) << k;
  }
}

// Metamorphic: where the map's origin is and how it is turned changes nothing but the rounding of scores, which decides
// between matches that are as good. A cell is 0.3 m.
TEST(ScanSlam, ATurnedAndMovedMapGivesTheTurnedAndMovedTrajectory) {
  PINGVOX_SKIP_UNDER_SANITIZERS();
  const ScannedDrive drive(kHarbour, kRound, {});
  const Pose turn = Eigen::Translation3d(300.0, -200.0, 5.0) * Eigen::AngleAxisd(2.0, Eigen::Vector3d::UnitZ());
  ScannedDrive turned = drive;
  for (PointScan& scan : turned.scans) {
    scan.origin_m = turn * scan.origin_m;
    scan.rotation = turn.rotation() * scan.rotation;
    for (Eigen::Vector3d& point : scan.points_m) point = turn * point;
  }
  const auto poses = solution_of(drive).trajectory.poses(), others = solution_of(turned).trajectory.poses();
  ASSERT_EQ(poses.size(), others.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_LT((turn * poses[i].map_from_body.translation() - others[i].map_from_body.translation()).norm(), 0.6) << i;
  }
}

// Each place of a straight canal looks like the next one: the walls tell where the vehicle is across, not along.
TEST(ScanSlam, IsNotPulledAlongAStraightCanal) {
  PINGVOX_SKIP_UNDER_SANITIZERS();
  constexpr std::array<Wall, 2> kCanal = {{{-100, -6, 300, -6}, {-100, 6, 300, 6}}};
  const ScannedDrive drive(kCanal, std::vector<Eigen::Vector2d>{{0, 0}, {120, 1}, {60, -1}, {100, 0}},
                           {.along = 0.02, .sideways = 0.0, .yaw_rad_m = 0.001});
  const ScanSlamSolution solution = solution_of(drive);
  const auto& poses = solution.trajectory.poses();
  ASSERT_EQ(poses.size(), drive.truth.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Eigen::Vector2d error_m = poses[i].map_from_body.translation().head<2>() - drive.truth[i].place_m;
    EXPECT_LT(std::abs(error_m.x()), std::abs(drive.odometry[i].place_m.x() - drive.truth[i].place_m.x()) + 1.0) << i;
  }
  EXPECT_LT(rmse_m(drive, solution), drive.odometry_rmse_m());
}

// Two bays that look the same, one after the other: the odometry tells them apart.
TEST(ScanSlam, DoesNotTakeABayForTheNextOne) {
  std::vector<Wall> bays = {{-30, -8, 130, -8}};
  for (const double x : {0.0, 30.0, 60.0, 90.0}) {
    bays.insert(bays.end(),
                {{x, 8, x + 4, 16}, {x + 4, 16, x + 16, 16}, {x + 16, 16, x + 18, 8}, {x + 18, 8, x + 30, 8}});
  }
  const ScannedDrive drive(bays, std::vector<Eigen::Vector2d>{{-10, 0}, {110, 0}},
                           {.along = 0.01, .sideways = 0.005, .yaw_rad_m = 0.0005});
  const ScanSlamSolution solution = solution_of(drive);
  EXPECT_LT(rmse_m(drive, solution), drive.odometry_rmse_m() + 0.5);
}

TEST(ScanSlam, RefusesWhatHasNoTrajectory) {
  ScanSlam slam;
  EXPECT_EQ(slam.solve().error().code, Error::Code::kUnsupported);
  slam.add({.origin_m = {0, 0, 0}, .points_m = {{1, 0, 0}}});
  EXPECT_EQ(slam.solve().error().code, Error::Code::kUnsupported);
  ScanSlam empty;
  empty.add({});
  empty.add({.origin_m = {}, .points_m = {}, .rotation = Eigen::Quaterniond::Identity(), .number = 1});
  EXPECT_EQ(empty.solve().error().code, Error::Code::kUnsupported);
  ScanSlam same_number;
  for (int i = 0; i < 2; ++i) same_number.add({.points_m = {{1, 0, 0}}});
  EXPECT_EQ(same_number.solve().error().code, Error::Code::kCorrupt);
}

TEST(ScanSlam, FewPointsAnywhereAreNoLoopAndNoHarm) {
  for (const double far : {1e-6, 1.0, 1e6}) {
    ScanSlam slam;
    for (std::size_t i = 0; i < 40; ++i) {
      slam.add({.origin_m = {0.1 * far * static_cast<double>(i), 0, 0},
                .points_m = {{far, 0, 0}, {0, far, 0}},
                .number = i});
    }
    const auto solution = slam.solve();
    ASSERT_TRUE(solution) << far;
    EXPECT_EQ(solution->report.loops_kept, 0U) << far;
  }
}

}  // namespace
}  // namespace pingvox::test
