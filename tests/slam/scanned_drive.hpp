#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include "pingvox/map/point_scan.hpp"
#include "tests/slam/walls.hpp"
#include "tests/support/uniform.hpp"

namespace pingvox::test {

/// Errors of odometry, as shares of the way.
struct Drift {
  double along = 0.02, sideways = 0.015;
  double yaw_rad_m = 0.002;
};

/// A vehicle with a forward-looking sonar of 120 degrees that follows a line from corner to corner.
struct ScannedDrive {
  struct State {
    Eigen::Vector2d place_m;
    double yaw_rad;
  };
  static constexpr double kStep_m = 1.0, kRange_m = 30.0, kHalfView_rad = std::numbers::pi / 3.0;

  std::vector<State> truth, odometry;
  std::vector<PointScan> scans;  ///< at the odometry's poses

  ScannedDrive(std::span<const Wall> walls, std::span<const Eigen::Vector2d> corners, const Drift& drift,
               std::uint64_t seed = 1) {
    follow(corners);
    std::mt19937_64 random(seed);
    odometry.push_back(truth.front());
    for (std::size_t i = 1; i < truth.size(); ++i) {
      const Eigen::Vector2d step =
          Eigen::Rotation2Dd(-truth[i - 1].yaw_rad) * (truth[i].place_m - truth[i - 1].place_m);
      const double length_m = step.norm();
      const Eigen::Vector2d measured = step + length_m * Eigen::Vector2d(drift.along, drift.sideways) +
                                       Eigen::Vector2d(uniform(random, -0.02, 0.02), uniform(random, -0.02, 0.02));
      const State& last = odometry.back();
      odometry.push_back({last.place_m + Eigen::Rotation2Dd(last.yaw_rad) * measured,
                          last.yaw_rad + truth[i].yaw_rad - truth[i - 1].yaw_rad + length_m * drift.yaw_rad_m});
    }
    for (std::size_t i = 0; i < truth.size(); ++i) scans.push_back(scan(walls, i, random));
  }

  /// Root mean square of the distances between places.
  template <typename Places>
  double rmse_m(const Places& places) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) sum += (places(i) - truth[i].place_m).squaredNorm();
    return std::sqrt(sum / static_cast<double>(truth.size()));
  }
  double odometry_rmse_m() const {
    return rmse_m([&](std::size_t i) { return odometry[i].place_m; });
  }

 private:
  void follow(std::span<const Eigen::Vector2d> corners) {
    const auto yaw_to = [](const Eigen::Vector2d& way) { return std::atan2(way.y(), way.x()); };
    State state{corners[0], yaw_to(corners[1] - corners[0])};
    truth.push_back(state);
    for (const Eigen::Vector2d& corner : corners.subspan(1)) {
      while ((corner - state.place_m).norm() > 1.5) {
        const double turn = std::remainder(yaw_to(corner - state.place_m) - state.yaw_rad, 2.0 * std::numbers::pi);
        state.yaw_rad += std::clamp(turn, -0.3, 0.3);
        if (std::abs(turn) < 0.8) {
          state.place_m += kStep_m * Eigen::Vector2d(std::cos(state.yaw_rad), std::sin(state.yaw_rad));
        }
        truth.push_back(state);
      }
    }
  }

  PointScan scan(std::span<const Wall> walls, std::size_t i, std::mt19937_64& random) const {
    PointScan scan;
    scan.number = i;
    scan.origin_m << odometry[i].place_m, -1.0;
    scan.rotation = Eigen::AngleAxisd(odometry[i].yaw_rad, Eigen::Vector3d::UnitZ());
    constexpr int kBeams = 40;
    for (int beam = 0; beam <= kBeams; ++beam) {
      const double bearing_rad = kHalfView_rad * (2.0 * beam / kBeams - 1.0);
      const double range_m = range_to_walls_m(walls, truth[i].place_m, truth[i].yaw_rad + bearing_rad);
      if (range_m > kRange_m) continue;
      const double measured_m = range_m + uniform(random, -0.15, 0.15);
      scan.points_m.push_back(scan.origin_m + scan.rotation * Eigen::Vector3d(measured_m * std::cos(bearing_rad),
                                                                              measured_m * std::sin(bearing_rad), 0.0));
    }
    return scan;
  }
};

}  // namespace pingvox::test
