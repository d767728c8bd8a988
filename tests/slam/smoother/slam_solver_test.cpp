#include "slam/smoother/slam_solver.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace pingvox::test {
namespace {

TimeSeries constant(double value) {
  return {{0.0, 20.0}, {value, value}};
}

/// Ahead at 0.5 m/s for 20 s, by a velocity that is good for 0.1 m after a second.
SlamSolver solver_ahead() {
  VelocitySource velocity{"dvl", constant(0.5), constant(0.0), constant(0.1), 0};
  std::vector<HeadingSource> headings;
  headings.push_back({"imu", constant(0.3), {}, {}});
  SlamProblem problem({0.0, 5.0, 10.0, 15.0, 20.0}, std::move(velocity), std::move(headings));
  Unknowns start = problem.dead_reckoning();
  return {std::move(problem), {}, {}, 1, std::move(start)};
}

TEST(SlamSolver, ALoopMovesTheKnotsThatItJoins) {
  SlamSolver solver = solver_ahead();
  // Half a metre less than dead reckoning, and known to a centimetre.
  PoseEdge loop{4, 1, solver.pose_of_knot(4).inverse() * solver.pose_of_knot(1), 1e4 * Eigen::Matrix3d::Identity()};
  loop.a_from_b.place_m.x() += 0.5;
  const auto off_m = [&] {
    return residual_of(loop, solver.pose_of_knot(loop.a), solver.pose_of_knot(loop.b)).head<2>().norm();
  };
  solver.set_loops({loop});
  EXPECT_NEAR(off_m(), 0.5, 1e-9);
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(solver.step(std::nullopt));
  EXPECT_LT(off_m(), 0.05);
  // Without it, back to dead reckoning.
  solver.set_loops({});
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(solver.step(std::nullopt));
  EXPECT_NEAR(off_m(), 0.5, 1e-3);
}

TEST(SlamSolver, ALoopWithWhatLeftMovesItsKnotThere) {
  SlamSolver solver = solver_ahead();
  const Pose2 fixed{{1.0, 2.0}, 0.4};
  FixedLoop loop{{4, 0, solver.pose_of_knot(4).inverse() * fixed, 1e4 * Eigen::Matrix3d::Identity()}, fixed};
  loop.edge.a_from_b.place_m.x() += 0.5;
  solver.set_loops({}, {loop});
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(solver.step(std::nullopt));
  EXPECT_LT(residual_of(loop.edge, solver.pose_of_knot(4), fixed).head<2>().norm(), 0.05);
}

}  // namespace
}  // namespace pingvox::test
