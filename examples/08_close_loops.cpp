// Closes the loops of a drive: a vehicle goes twice round a basin, its odometry drifts, and what it sees tells where it
// has been before.
//
//   08_close_loops
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <pingvox/slam/loop_finder.hpp>
#include <pingvox/slam/pose_graph.hpp>
#include <vector>

using namespace pingvox;

constexpr double kReach_m = 25.0;

// The walls of a basin, corner by corner, and how far one is from a place in a direction.
constexpr std::array<std::array<double, 2>, 11> kCorners = {
    {{-30, -18}, {8, -22}, {31, -20}, {28, 4}, {34, 21}, {6, 17}, {3, 25}, {-12, 22}, {-28, 24}, {-34, 3}, {-30, -18}}};

double range_m(const Eigen::Vector2d& from, double direction_rad) {
  const Eigen::Vector2d ray(std::cos(direction_rad), std::sin(direction_rad));
  double nearest_m = 2.0 * kReach_m;
  for (std::size_t i = 0; i + 1 < kCorners.size(); ++i) {
    const Eigen::Vector2d a(kCorners[i][0], kCorners[i][1]), b(kCorners[i + 1][0], kCorners[i + 1][1]);
    const Eigen::Vector2d wall = b - a, to_wall = a - from;
    const double cross = ray.x() * wall.y() - ray.y() * wall.x();
    const double along_m = (to_wall.x() * wall.y() - to_wall.y() * wall.x()) / cross;
    const double share = (to_wall.x() * ray.y() - to_wall.y() * ray.x()) / cross;
    if (along_m > 0.0 && share >= 0.0 && share <= 1.0) nearest_m = std::min(nearest_m, along_m);
  }
  return nearest_m;
}

std::vector<Eigen::Vector2d> look_around(const Pose2& vehicle) {
  std::vector<Eigen::Vector2d> points_m;
  for (int i = 0; i < 200; ++i) {
    const double bearing_rad = 2.0 * std::numbers::pi * i / 200.0;
    const double far_m = range_m(vehicle.place_m, vehicle.yaw_rad + bearing_rad);
    if (far_m < kReach_m) points_m.emplace_back(far_m * Eigen::Vector2d(std::cos(bearing_rad), std::sin(bearing_rad)));
  }
  return points_m;
}

// An ellipse, twice.
Pose2 pose_on_way(int step) {
  const double phase = 2.0 * std::numbers::pi * step / 80.0;
  return {{18.0 * std::cos(phase), 11.0 * std::sin(phase)},
          std::atan2(11.0 * std::cos(phase), -18.0 * std::sin(phase))};
}

int main() {
  std::vector<Pose2> truth;
  std::vector<KeyFrame> frames;
  std::vector<PoseEdge> odometry;
  Pose2 reckoned = pose_on_way(0);
  for (int step = 0; step < 160; ++step) {
    truth.push_back(pose_on_way(step));
    if (step > 0) {
      Pose2 moved = truth[truth.size() - 2].inverse() * truth.back();
      moved.yaw_rad += 0.002;  // a gyro that drifts
      moved.place_m *= 1.01;   // a speed that is too high
      const auto k = static_cast<std::size_t>(step);
      const Eigen::Vector3d deviation = odometry_deviation(moved.place_m.norm(), std::abs(moved.yaw_rad), kReach_m);
      odometry.push_back({k - 1, k, moved, deviation.cwiseAbs2().cwiseInverse().asDiagonal()});
      reckoned = reckoned * moved;
    }
    frames.push_back({reckoned, look_around(truth.back())});
  }

  std::vector<Pose2> poses;
  for (const KeyFrame& frame : frames) poses.push_back(frame.odometry);
  const auto error_m = [&] { return (poses.back().place_m - truth.back().place_m).norm(); };
  const double before_m = error_m();
  const Loops loops = find_loops(frames, poses, {.reach_m = kReach_m, .window_m = 10.0, .window_yaw_rad = 0.4});
  solve_pose_graph(poses, odometry, loops.kept);
  std::printf("%zu loops, the last place is off by %.2f m, before by %.2f m\n", loops.kept.size(), error_m(), before_m);
  return error_m() < 0.5 * before_m ? 0 : 1;
}
